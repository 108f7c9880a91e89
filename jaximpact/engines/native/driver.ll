; Made from driver.c by 'make driver'; sha256 a0201107d6436b329d9e1a235b763f724da312b2e2022be395a506afe1e7b872

%struct.Operation = type { i64, [32 x %struct.Program], i64, i64, i64, i64, ptr, ptr }
%struct.Program = type { ptr, ptr, ptr, ptr, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, double, double, [7 x double] }
%struct.Matrices = type { %struct.Exchange, ptr, i64, i64, ptr, ptr, i64, i64, ptr }
%struct.Exchange = type { ptr, ptr, ptr, ptr }
%struct.Columns = type { ptr, [8 x i64], [8 x double], [8 x i64], [8 x i64] }
%struct.anon = type { i64, ptr, ptr, i32 }
%struct.Job = type { i64, [24 x i64], i64, ptr, ptr, i64, ptr, [32 x i64], [32 x i64], i64, i32 }
%struct.Operand = type { ptr, [24 x i64] }
%struct.Turn = type { double, i64 }
%struct.Share = type { %struct.Exchange, ptr, i32 }

@operation = dso_local global %struct.Operation zeroinitializer, align 8
@.str = private unnamed_addr constant [38 x i8] c"jaximpact: a wrong number of operands\00", align 1
@.str.1 = private unnamed_addr constant [25 x i8] c"jaximpact: out of memory\00", align 1
@.str.2 = private unnamed_addr constant [37 x i8] c"jaximpact: a wrong number of results\00", align 1
@.str.3 = private unnamed_addr constant [41 x i8] c"jaximpact: operands differ in their axes\00", align 1
@.str.4 = private unnamed_addr constant [63 x i8] c"jaximpact computes in float64, but an operand has another type\00", align 1
@.str.5 = private unnamed_addr constant [36 x i8] c"jaximpact: too few or too many axes\00", align 1

define dso_local i64 @run(ptr noundef %0, ptr noundef %1, ptr noundef %2, i64 noundef %3, ptr noundef %4, ptr noundef %5, i64 noundef %6, ptr noundef %7, i64 noundef %8) local_unnamed_addr {
  %10 = alloca %struct.Matrices, align 8
  call void @llvm.lifetime.start.p0(i64 96, ptr nonnull %10)
  store ptr @take_column, ptr %10, align 8
  %11 = getelementptr inbounds %struct.Exchange, ptr %10, i64 0, i32 1
  store ptr @give_column, ptr %11, align 8
  %12 = getelementptr inbounds %struct.Exchange, ptr %10, i64 0, i32 2
  %13 = getelementptr inbounds %struct.Matrices, ptr %10, i64 0, i32 1
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(16) %12, i8 0, i64 16, i1 false)
  store ptr %2, ptr %13, align 8
  %14 = getelementptr inbounds %struct.Matrices, ptr %10, i64 0, i32 2
  store i64 %3, ptr %14, align 8
  %15 = getelementptr inbounds %struct.Matrices, ptr %10, i64 0, i32 3
  store i64 0, ptr %15, align 8
  %16 = getelementptr inbounds %struct.Matrices, ptr %10, i64 0, i32 4
  store ptr %4, ptr %16, align 8
  %17 = getelementptr inbounds %struct.Matrices, ptr %10, i64 0, i32 5
  store ptr %5, ptr %17, align 8
  %18 = getelementptr inbounds %struct.Matrices, ptr %10, i64 0, i32 6
  store i64 %6, ptr %18, align 8
  %19 = getelementptr inbounds %struct.Matrices, ptr %10, i64 0, i32 7
  store i64 0, ptr %19, align 8
  %20 = getelementptr inbounds %struct.Matrices, ptr %10, i64 0, i32 8
  store ptr %7, ptr %20, align 8
  %21 = tail call i64 @enter_float_mode()
  %22 = trunc i64 %8 to i32
  call fastcc void @go_on(ptr noundef %0, ptr noundef %1, ptr noundef nonnull %10, i32 noundef %22)
  call void @leave_float_mode(i64 noundef %21)
  %23 = load i64, ptr %19, align 8
  call void @llvm.lifetime.end.p0(i64 96, ptr nonnull %10)
  ret i64 %23
}

declare void @llvm.lifetime.start.p0(i64 immarg, ptr nocapture)

define internal i32 @take_column(ptr nocapture noundef %0, ptr nocapture noundef readonly %1, ptr nocapture noundef %2, i32 noundef %3) {
  %5 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 3
  %6 = load i64, ptr %5, align 8
  %7 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 2
  %8 = load i64, ptr %7, align 8
  %9 = icmp eq i64 %6, %8
  br i1 %9, label %42, label %10

10:
  %11 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 5
  %12 = load i64, ptr %11, align 8
  %13 = icmp sgt i64 %12, 0
  br i1 %13, label %14, label %17

14:
  %15 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 1
  %16 = sext i32 %3 to i64
  br label %26

17:
  %18 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 4
  %19 = load ptr, ptr %18, align 8
  %20 = load i64, ptr %5, align 8
  %21 = add nsw i64 %20, 1
  store i64 %21, ptr %5, align 8
  %22 = getelementptr inbounds i64, ptr %19, i64 %20
  %23 = load i64, ptr %22, align 8
  %24 = sext i32 %3 to i64
  %25 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %24
  store i64 %23, ptr %25, align 8
  br label %42

26:
  %27 = phi i64 [ 0, %14 ], [ %39, %26 ]
  %28 = load ptr, ptr %15, align 8
  %29 = load i64, ptr %7, align 8
  %30 = mul nsw i64 %29, %27
  %31 = load i64, ptr %5, align 8
  %32 = add nsw i64 %30, %31
  %33 = getelementptr inbounds double, ptr %28, i64 %32
  %34 = load double, ptr %33, align 8
  %35 = load ptr, ptr %2, align 8
  %36 = shl nsw i64 %27, 3
  %37 = add nsw i64 %36, %16
  %38 = getelementptr inbounds double, ptr %35, i64 %37
  store double %34, ptr %38, align 8
  %39 = add nuw nsw i64 %27, 1
  %40 = load i64, ptr %11, align 8
  %41 = icmp slt i64 %39, %40
  br i1 %41, label %26, label %17

42:
  %43 = phi i32 [ 1, %17 ], [ 0, %4 ]
  ret i32 %43
}

define internal void @give_column(ptr nocapture noundef %0, ptr nocapture noundef readonly %1, ptr nocapture noundef readonly %2, i32 noundef %3) {
  %5 = load ptr, ptr %2, align 8
  %6 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 6
  %7 = load i64, ptr %6, align 8
  %8 = shl nsw i64 %7, 3
  %9 = getelementptr inbounds double, ptr %5, i64 %8
  %10 = sext i32 %3 to i64
  %11 = getelementptr inbounds double, ptr %9, i64 %10
  %12 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 7
  %13 = load i64, ptr %12, align 8
  %14 = icmp sgt i64 %13, 0
  br i1 %14, label %15, label %19

15:
  %16 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 5
  %17 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 6
  %18 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 7
  br label %28

19:
  %20 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %10
  %21 = load i64, ptr %20, align 8
  %22 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 8
  %23 = load ptr, ptr %22, align 8
  %24 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 7
  %25 = load i64, ptr %24, align 8
  %26 = add nsw i64 %25, 1
  store i64 %26, ptr %24, align 8
  %27 = getelementptr inbounds i64, ptr %23, i64 %25
  store i64 %21, ptr %27, align 8
  ret void

28:
  %29 = phi i64 [ 0, %15 ], [ %39, %28 ]
  %30 = shl nsw i64 %29, 3
  %31 = getelementptr inbounds double, ptr %11, i64 %30
  %32 = load double, ptr %31, align 8
  %33 = load ptr, ptr %16, align 8
  %34 = load i64, ptr %17, align 8
  %35 = mul nsw i64 %34, %29
  %36 = load i64, ptr %18, align 8
  %37 = add nsw i64 %35, %36
  %38 = getelementptr inbounds double, ptr %33, i64 %37
  store double %32, ptr %38, align 8
  %39 = add nuw nsw i64 %29, 1
  %40 = load i64, ptr %12, align 8
  %41 = icmp slt i64 %39, %40
  br i1 %41, label %28, label %19
}

define internal fastcc void @go_on(ptr noundef %0, ptr noundef %1, ptr noundef %2, i32 noundef %3) unnamed_addr {
  %5 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 8
  %6 = icmp eq i32 %3, 0
  %7 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 1
  %8 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 3
  %9 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 11
  %10 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 12
  %11 = getelementptr inbounds %struct.Exchange, ptr %2, i64 0, i32 2
  %12 = getelementptr inbounds %struct.Exchange, ptr %2, i64 0, i32 3
  %13 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 2
  %14 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 8
  %15 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 6
  %16 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 9
  %17 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 15
  %18 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 10
  %19 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 16
  %20 = getelementptr inbounds %struct.Exchange, ptr %2, i64 0, i32 1
  br label %21

21:
  %22 = phi i8 [ 0, %4 ], [ %199, %198 ]
  br label %25

23:
  %24 = icmp eq i8 %55, 0
  br i1 %24, label %69, label %65

25:
  %26 = phi i64 [ 0, %21 ], [ %63, %54 ]
  %27 = phi i8 [ %22, %21 ], [ %55, %54 ]
  %28 = phi i8 [ 0, %21 ], [ %62, %54 ]
  %29 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 1, i64 %26
  %30 = load i64, ptr %29, align 8
  %31 = icmp slt i64 %30, 0
  br i1 %31, label %32, label %54

32:
  %33 = load ptr, ptr %2, align 8
  %34 = trunc i64 %26 to i32
  %35 = tail call i32 %33(ptr noundef nonnull %2, ptr noundef %0, ptr noundef %1, i32 noundef %34)
  %36 = icmp eq i32 %35, 0
  br i1 %36, label %54, label %37

37:
  %38 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 4, i64 %26
  store i64 0, ptr %38, align 8
  %39 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 3, i64 %26
  store i64 0, ptr %39, align 8
  %40 = load i64, ptr %5, align 8
  %41 = icmp sgt i64 %40, -1
  br i1 %41, label %42, label %49

42:
  %43 = load ptr, ptr %1, align 8
  %44 = shl nsw i64 %40, 3
  %45 = add nsw i64 %44, %26
  %46 = getelementptr inbounds double, ptr %43, i64 %45
  %47 = load double, ptr %46, align 8
  %48 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 2, i64 %26
  store double %47, ptr %48, align 8
  br label %49

49:
  %50 = trunc i64 %26 to i32
  %51 = shl nuw i32 1, %50
  %52 = trunc i32 %51 to i8
  %53 = or i8 %27, %52
  br label %54

54:
  %55 = phi i8 [ %53, %49 ], [ %27, %32 ], [ %27, %25 ]
  %56 = load i64, ptr %29, align 8
  %57 = trunc i64 %26 to i32
  %58 = shl nuw i32 1, %57
  %59 = trunc i32 %58 to i8
  %60 = icmp slt i64 %56, 0
  %61 = select i1 %60, i8 0, i8 %59
  %62 = or i8 %61, %28
  %63 = add nuw nsw i64 %26, 1
  %64 = icmp eq i64 %63, 8
  br i1 %64, label %23, label %25

65:
  %66 = load ptr, ptr %0, align 8
  %67 = load ptr, ptr %1, align 8
  %68 = tail call zeroext i8 %66(ptr noundef %67, i8 noundef zeroext %55)
  br label %69

69:
  %70 = icmp eq i8 %62, 0
  %71 = icmp ne i8 %62, -1
  %72 = select i1 %6, i1 %70, i1 %71
  br i1 %72, label %198, label %73

73:
  %74 = zext i8 %62 to i32
  br label %75

75:
  %76 = load ptr, ptr %7, align 8
  %77 = load ptr, ptr %1, align 8
  %78 = tail call zeroext i8 %76(ptr noundef %77, i8 noundef zeroext -1)
  %79 = xor i8 %78, -1
  %80 = and i8 %62, %79
  %81 = load ptr, ptr %8, align 8
  %82 = icmp eq ptr %81, null
  br i1 %82, label %136, label %83

83:
  %84 = load ptr, ptr %1, align 8
  %85 = load i64, ptr %9, align 8
  %86 = shl nsw i64 %85, 3
  %87 = getelementptr inbounds double, ptr %84, i64 %86
  %88 = load i64, ptr %10, align 8
  %89 = shl nsw i64 %88, 3
  %90 = getelementptr inbounds double, ptr %84, i64 %89
  br label %93

91:
  %92 = icmp eq i8 %111, 0
  br i1 %92, label %136, label %117

93:
  %94 = phi i64 [ 0, %83 ], [ %115, %114 ]
  %95 = phi i8 [ 0, %83 ], [ %116, %114 ]
  %96 = trunc i64 %94 to i32
  %97 = shl nuw i32 1, %96
  %98 = and i32 %97, %74
  %99 = icmp eq i32 %98, 0
  br i1 %99, label %110, label %100

100:
  %101 = load ptr, ptr %11, align 8
  %102 = tail call double %101(ptr noundef %2, ptr noundef nonnull %1, i32 noundef %96)
  %103 = getelementptr inbounds double, ptr %90, i64 %94
  store double %102, ptr %103, align 8
  %104 = getelementptr inbounds double, ptr %87, i64 %94
  %105 = load double, ptr %104, align 8
  %106 = fcmp ugt double %102, %105
  br i1 %106, label %110, label %107

107:
  %108 = trunc i32 %97 to i8
  %109 = or i8 %95, %108
  br label %110

110:
  %111 = phi i8 [ %109, %107 ], [ %95, %100 ], [ %95, %93 ]
  %112 = add nuw nsw i64 %94, 1
  %113 = icmp eq i64 %112, 8
  br i1 %113, label %91, label %114

114:
  %115 = phi i64 [ %112, %110 ], [ 0, %133 ]
  %116 = phi i8 [ %111, %110 ], [ 0, %133 ]
  br label %93

117:
  %118 = load ptr, ptr %8, align 8
  %119 = load ptr, ptr %1, align 8
  %120 = tail call zeroext i8 %118(ptr noundef %119, i8 noundef zeroext %111)
  %121 = zext i8 %111 to i32
  br label %122

122:
  %123 = phi i64 [ 0, %117 ], [ %134, %133 ]
  %124 = trunc i64 %123 to i32
  %125 = shl nuw i32 1, %124
  %126 = and i32 %125, %121
  %127 = icmp eq i32 %126, 0
  br i1 %127, label %133, label %128

128:
  %129 = load ptr, ptr %12, align 8
  tail call void %129(ptr noundef %2, ptr noundef %0, ptr noundef nonnull %1, i32 noundef %124)
  %130 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 4, i64 %123
  %131 = load i64, ptr %130, align 8
  %132 = add nsw i64 %131, 1
  store i64 %132, ptr %130, align 8
  br label %133

133:
  %134 = add nuw nsw i64 %123, 1
  %135 = icmp eq i64 %134, 8
  br i1 %135, label %114, label %122

136:
  %137 = icmp eq i8 %80, 0
  br i1 %137, label %75, label %138

138:
  %139 = load ptr, ptr %13, align 8
  %140 = load ptr, ptr %1, align 8
  %141 = tail call zeroext i8 %139(ptr noundef %140, i8 noundef zeroext -1)
  %142 = zext i8 %80 to i32
  br label %143

143:
  %144 = phi i64 [ 0, %138 ], [ %196, %194 ]
  %145 = phi i8 [ 0, %138 ], [ %195, %194 ]
  %146 = trunc i64 %144 to i32
  %147 = shl nuw i32 1, %146
  %148 = and i32 %147, %142
  %149 = icmp eq i32 %148, 0
  br i1 %149, label %194, label %150

150:
  %151 = load i64, ptr %14, align 8
  %152 = icmp slt i64 %151, 0
  br i1 %152, label %190, label %153

153:
  %154 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 3, i64 %144
  %155 = load i64, ptr %154, align 8
  %156 = icmp eq i64 %155, 7
  br i1 %156, label %190, label %157

157:
  %158 = load ptr, ptr %1, align 8
  %159 = load i64, ptr %15, align 8
  %160 = shl nsw i64 %159, 3
  %161 = getelementptr inbounds double, ptr %158, i64 %160
  %162 = getelementptr inbounds double, ptr %161, i64 %144
  %163 = load i64, ptr %16, align 8
  %164 = shl nsw i64 %163, 3
  %165 = getelementptr inbounds double, ptr %162, i64 %164
  %166 = load double, ptr %165, align 8
  %167 = load double, ptr %17, align 8
  %168 = fcmp une double %166, %167
  br i1 %168, label %190, label %169

169:
  %170 = load i64, ptr %18, align 8
  %171 = shl nsw i64 %170, 3
  %172 = getelementptr inbounds double, ptr %162, i64 %171
  %173 = load double, ptr %172, align 8
  %174 = load double, ptr %19, align 8
  %175 = fcmp ult double %173, %174
  br i1 %175, label %176, label %190

176:
  %177 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 2, i64 %144
  %178 = load double, ptr %177, align 8
  %179 = getelementptr inbounds %struct.Program, ptr %0, i64 0, i32 17, i64 %155
  %180 = load double, ptr %179, align 8
  %181 = fmul double %178, %180
  %182 = shl nsw i64 %151, 3
  %183 = add nsw i64 %182, %144
  %184 = getelementptr inbounds double, ptr %158, i64 %183
  store double %181, ptr %184, align 8
  %185 = load i64, ptr %154, align 8
  %186 = add nsw i64 %185, 1
  store i64 %186, ptr %154, align 8
  %187 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 4, i64 %144
  store i64 0, ptr %187, align 8
  %188 = trunc i32 %147 to i8
  %189 = or i8 %145, %188
  br label %194

190:
  %191 = load ptr, ptr %20, align 8
  %192 = trunc i64 %144 to i32
  tail call void %191(ptr noundef %2, ptr noundef %0, ptr noundef nonnull %1, i32 noundef %192)
  %193 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 1, i64 %144
  store i64 -1, ptr %193, align 8
  br label %194

194:
  %195 = phi i8 [ %189, %176 ], [ %145, %190 ], [ %145, %143 ]
  %196 = add nuw nsw i64 %144, 1
  %197 = icmp eq i64 %196, 8
  br i1 %197, label %198, label %143

198:
  %199 = phi i8 [ %22, %69 ], [ %195, %194 ]
  br i1 %72, label %200, label %21

200:
  ret void
}

declare void @llvm.lifetime.end.p0(i64 immarg, ptr nocapture)

define dso_local ptr @impacts(ptr nocapture noundef readonly %0) local_unnamed_addr {
  %2 = alloca %struct.anon, align 8
  %3 = alloca %struct.anon, align 8
  %4 = alloca %struct.anon, align 8
  %5 = alloca %struct.anon, align 8
  %6 = alloca %struct.anon, align 8
  %7 = alloca %struct.anon, align 8
  %8 = alloca %struct.Job, align 8
  %9 = getelementptr inbounds i8, ptr %0, i64 8
  %10 = load ptr, ptr %9, align 8
  %11 = icmp eq ptr %10, null
  br i1 %11, label %21, label %12

12:
  %13 = getelementptr inbounds i8, ptr %10, i64 8
  %14 = load i32, ptr %13, align 4
  %15 = icmp eq i32 %14, 1
  br i1 %15, label %16, label %21

16:
  %17 = getelementptr inbounds i8, ptr %10, i64 24
  %18 = load ptr, ptr %17, align 8
  %19 = getelementptr inbounds i8, ptr %18, i64 24
  store i32 0, ptr %19, align 4
  %20 = getelementptr inbounds i8, ptr %18, i64 28
  store i32 1, ptr %20, align 4
  br label %372

21:
  %22 = getelementptr inbounds i8, ptr %0, i64 56
  %23 = load i64, ptr %22, align 8
  %24 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 2), align 8
  %25 = add nsw i64 %24, 2
  %26 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 3), align 8
  %27 = icmp sgt i64 %26, 0
  %28 = zext i1 %27 to i64
  %29 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 4), align 8
  %30 = add i64 %25, %29
  %31 = add i64 %30, %28
  %32 = icmp eq i64 %23, %31
  br i1 %32, label %42, label %33

33:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %7)
  store i64 32, ptr %7, align 8
  %34 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 1
  store ptr null, ptr %34, align 8
  %35 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 2
  store ptr @.str, ptr %35, align 8
  %36 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 3
  store i32 3, ptr %36, align 8
  %37 = getelementptr inbounds i8, ptr %0, i64 16
  %38 = load ptr, ptr %37, align 8
  %39 = getelementptr inbounds i8, ptr %38, i64 48
  %40 = load ptr, ptr %39, align 8
  %41 = call ptr %40(ptr noundef nonnull %7)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %7)
  br label %372

42:
  %43 = mul i64 %23, 200
  %44 = tail call noalias ptr @malloc(i64 noundef %43)
  %45 = icmp eq ptr %44, null
  br i1 %45, label %46, label %55

46:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %6)
  store i64 32, ptr %6, align 8
  %47 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 1
  store ptr null, ptr %47, align 8
  %48 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 2
  store ptr @.str.1, ptr %48, align 8
  %49 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 3
  store i32 8, ptr %49, align 8
  %50 = getelementptr inbounds i8, ptr %0, i64 16
  %51 = load ptr, ptr %50, align 8
  %52 = getelementptr inbounds i8, ptr %51, i64 48
  %53 = load ptr, ptr %52, align 8
  %54 = call ptr %53(ptr noundef nonnull %6)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %6)
  br label %372

55:
  call void @llvm.lifetime.start.p0(i64 768, ptr nonnull %8)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(768) %8, i8 0, i64 768, i1 false)
  %56 = getelementptr inbounds i8, ptr %0, i64 72
  %57 = load ptr, ptr %56, align 8
  %58 = getelementptr inbounds i8, ptr %0, i64 112
  %59 = load ptr, ptr %58, align 8
  %60 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 1, i64 0, i32 7), align 8
  %61 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 1, i64 0, i32 14), align 8
  %62 = getelementptr inbounds i8, ptr %0, i64 96
  %63 = load i64, ptr %62, align 8
  %64 = add nsw i64 %61, %60
  %65 = icmp eq i64 %63, %64
  br i1 %65, label %85, label %66

66:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %5)
  store i64 32, ptr %5, align 8
  %67 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 1
  store ptr null, ptr %67, align 8
  %68 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 2
  store ptr @.str.2, ptr %68, align 8
  %69 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 3
  store i32 3, ptr %69, align 8
  %70 = getelementptr inbounds i8, ptr %0, i64 16
  %71 = load ptr, ptr %70, align 8
  %72 = getelementptr inbounds i8, ptr %71, i64 48
  %73 = load ptr, ptr %72, align 8
  %74 = call ptr %73(ptr noundef nonnull %5)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %5)
  br label %370

75:
  %76 = icmp sgt i64 %23, 0
  br i1 %76, label %77, label %167

77:
  %78 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 1
  %79 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 2
  %80 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 3
  %81 = getelementptr inbounds i8, ptr %0, i64 16
  %82 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 1
  %83 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 2
  %84 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 3
  br label %94

85:
  %86 = phi i64 [ %88, %85 ], [ 0, %55 ]
  %87 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1, i64 %86
  store i64 1, ptr %87, align 8
  %88 = add nuw nsw i64 %86, 1
  %89 = icmp eq i64 %88, 24
  br i1 %89, label %75, label %85

90:
  %91 = add nuw nsw i64 %98, 1
  %92 = icmp slt i64 %91, %23
  %93 = icmp eq i64 %91, %23
  br i1 %93, label %167, label %94

94:
  %95 = phi i1 [ true, %77 ], [ %92, %90 ]
  %96 = phi ptr [ undef, %77 ], [ %166, %90 ]
  %97 = phi i64 [ -1, %77 ], [ %165, %90 ]
  %98 = phi i64 [ 0, %77 ], [ %91, %90 ]
  %99 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 2), align 8
  %100 = add nsw i64 %99, 2
  %101 = icmp sge i64 %98, %100
  %102 = zext i1 %101 to i64
  %103 = getelementptr inbounds ptr, ptr %57, i64 %98
  %104 = load ptr, ptr %103, align 8
  %105 = getelementptr inbounds %struct.Operand, ptr %44, i64 %98
  %106 = getelementptr inbounds i8, ptr %104, i64 32
  %107 = load i64, ptr %106, align 8
  %108 = getelementptr inbounds i8, ptr %104, i64 40
  %109 = load ptr, ptr %108, align 8
  %110 = getelementptr inbounds i8, ptr %104, i64 16
  %111 = load i32, ptr %110, align 4
  %112 = icmp eq i32 %111, 12
  br i1 %112, label %113, label %143

113:
  %114 = icmp slt i64 %107, %102
  br i1 %114, label %143, label %115

115:
  %116 = sub nsw i64 %107, %102
  %117 = icmp sgt i64 %116, 24
  br i1 %117, label %143, label %118

118:
  %119 = getelementptr inbounds i8, ptr %104, i64 24
  %120 = load ptr, ptr %119, align 8
  store ptr %120, ptr %105, align 8
  store i64 %116, ptr %8, align 8
  %121 = icmp sgt i64 %107, 0
  br i1 %121, label %122, label %143

122:
  %123 = phi i64 [ %125, %138 ], [ %107, %118 ]
  %124 = phi i64 [ %141, %138 ], [ 1, %118 ]
  %125 = add nsw i64 %123, -1
  %126 = load i64, ptr %8, align 8
  %127 = icmp sgt i64 %123, %126
  br i1 %127, label %138, label %128

128:
  %129 = getelementptr inbounds i64, ptr %109, i64 %125
  %130 = load i64, ptr %129, align 8
  %131 = icmp eq i64 %130, 1
  %132 = select i1 %131, i64 0, i64 %124
  %133 = getelementptr inbounds %struct.Operand, ptr %44, i64 %98, i32 1, i64 %125
  store i64 %132, ptr %133, align 8
  %134 = load i64, ptr %129, align 8
  %135 = icmp eq i64 %134, 1
  br i1 %135, label %138, label %136

136:
  %137 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1, i64 %125
  store i64 %134, ptr %137, align 8
  br label %138

138:
  %139 = getelementptr inbounds i64, ptr %109, i64 %125
  %140 = load i64, ptr %139, align 8
  %141 = mul nsw i64 %140, %124
  %142 = icmp sgt i64 %123, 1
  br i1 %142, label %122, label %143

143:
  %144 = phi i1 [ false, %94 ], [ false, %113 ], [ false, %115 ], [ true, %118 ], [ true, %138 ]
  %145 = phi ptr [ @.str.4, %94 ], [ @.str.5, %113 ], [ @.str.5, %115 ], [ null, %118 ], [ null, %138 ]
  br i1 %144, label %151, label %146

146:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %4)
  store i64 32, ptr %4, align 8
  store ptr null, ptr %78, align 8
  store ptr %145, ptr %79, align 8
  store i32 3, ptr %80, align 8
  %147 = load ptr, ptr %81, align 8
  %148 = getelementptr inbounds i8, ptr %147, i64 48
  %149 = load ptr, ptr %148, align 8
  %150 = call ptr %149(ptr noundef nonnull %4)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %4)
  br label %163

151:
  %152 = icmp slt i64 %97, 0
  %153 = load i64, ptr %8, align 8
  %154 = icmp eq i64 %153, %97
  %155 = select i1 %152, i1 true, i1 %154
  br i1 %155, label %161, label %156

156:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %3)
  store i64 32, ptr %3, align 8
  store ptr null, ptr %82, align 8
  store ptr @.str.3, ptr %83, align 8
  store i32 3, ptr %84, align 8
  %157 = load ptr, ptr %81, align 8
  %158 = getelementptr inbounds i8, ptr %157, i64 48
  %159 = load ptr, ptr %158, align 8
  %160 = call ptr %159(ptr noundef nonnull %3)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %3)
  br label %163

161:
  %162 = load i64, ptr %8, align 8
  br label %163

163:
  %164 = phi i1 [ true, %161 ], [ false, %156 ], [ false, %146 ]
  %165 = phi i64 [ %162, %161 ], [ %97, %156 ], [ %97, %146 ]
  %166 = phi ptr [ %96, %161 ], [ %160, %156 ], [ %150, %146 ]
  br i1 %164, label %90, label %167

167:
  %168 = phi i1 [ %76, %75 ], [ %95, %163 ], [ %92, %90 ]
  %169 = phi ptr [ undef, %75 ], [ %166, %90 ], [ %166, %163 ]
  br i1 %168, label %370, label %170

170:
  %171 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 4), align 8
  %172 = icmp eq i64 %171, 0
  br i1 %172, label %183, label %173

173:
  %174 = add nsw i64 %23, -1
  %175 = getelementptr inbounds ptr, ptr %57, i64 %174
  %176 = load ptr, ptr %175, align 8
  %177 = getelementptr inbounds i8, ptr %176, i64 40
  %178 = load ptr, ptr %177, align 8
  %179 = load i64, ptr %8, align 8
  %180 = getelementptr inbounds i64, ptr %178, i64 %179
  %181 = load i64, ptr %180, align 8
  %182 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 5
  store i64 %181, ptr %182, align 8
  br label %183

183:
  %184 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 3
  store ptr %44, ptr %184, align 8
  %185 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 2
  store i64 1, ptr %185, align 8
  %186 = load i64, ptr %8, align 8
  %187 = icmp sgt i64 %186, 0
  br i1 %187, label %194, label %188

188:
  %189 = load i64, ptr @operation, align 8
  %190 = icmp sgt i64 %189, 0
  br i1 %190, label %191, label %203

191:
  %192 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 9
  %193 = load i64, ptr %192, align 8
  br label %206

194:
  %195 = phi i64 [ %199, %194 ], [ 1, %183 ]
  %196 = phi i64 [ %200, %194 ], [ 0, %183 ]
  %197 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1, i64 %196
  %198 = load i64, ptr %197, align 8
  %199 = mul nsw i64 %198, %195
  store i64 %199, ptr %185, align 8
  %200 = add nuw nsw i64 %196, 1
  %201 = icmp eq i64 %200, %186
  br i1 %201, label %188, label %194

202:
  store i64 %213, ptr %192, align 8
  br label %203

203:
  %204 = load i64, ptr %185, align 8
  %205 = icmp eq i64 %204, 0
  br i1 %205, label %370, label %217

206:
  %207 = phi i64 [ %193, %191 ], [ %213, %206 ]
  %208 = phi i64 [ %193, %191 ], [ %214, %206 ]
  %209 = phi i64 [ 0, %191 ], [ %215, %206 ]
  %210 = getelementptr inbounds %struct.Operation, ptr @operation, i64 0, i32 1, i64 %209, i32 4
  %211 = load i64, ptr %210, align 8
  %212 = icmp sgt i64 %211, %208
  %213 = select i1 %212, i64 %211, i64 %207
  %214 = call i64 @llvm.smax.i64(i64 %211, i64 %208)
  %215 = add nuw nsw i64 %209, 1
  %216 = icmp eq i64 %215, %189
  br i1 %216, label %202, label %206

217:
  %218 = shl i64 %64, 3
  %219 = call noalias ptr @malloc(i64 noundef %218)
  %220 = shl i64 %204, 4
  %221 = call noalias ptr @malloc(i64 noundef %220)
  %222 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 6
  store ptr %221, ptr %222, align 8
  %223 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 4
  store ptr %219, ptr %223, align 8
  %224 = icmp eq ptr %219, null
  %225 = icmp eq ptr %221, null
  %226 = or i1 %224, %225
  br i1 %226, label %354, label %227

227:
  %228 = icmp sgt i64 %64, 0
  br i1 %228, label %345, label %229

229:
  %230 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 2), align 8
  %231 = getelementptr inbounds %struct.Operand, ptr %44, i64 %230
  %232 = add nsw i64 %230, 1
  %233 = getelementptr inbounds %struct.Operand, ptr %44, i64 %232
  br i1 %190, label %234, label %306

234:
  %235 = phi i64 [ %303, %300 ], [ 0, %229 ]
  %236 = phi i64 [ %240, %300 ], [ 0, %229 ]
  %237 = load i64, ptr %185, align 8
  %238 = icmp sgt i64 %237, 0
  br i1 %238, label %243, label %239

239:
  %240 = phi i64 [ %236, %234 ], [ %293, %292 ]
  %241 = sub nsw i64 %240, %236
  %242 = icmp sgt i64 %241, 8
  br i1 %242, label %297, label %300

243:
  %244 = phi i64 [ %294, %292 ], [ 0, %234 ]
  %245 = phi i64 [ %293, %292 ], [ %236, %234 ]
  %246 = load ptr, ptr %233, align 8
  %247 = load i64, ptr %8, align 8
  %248 = icmp sgt i64 %247, 0
  br i1 %248, label %249, label %263

249:
  %250 = phi i64 [ %253, %249 ], [ %247, %243 ]
  %251 = phi ptr [ %260, %249 ], [ %246, %243 ]
  %252 = phi i64 [ %261, %249 ], [ %244, %243 ]
  %253 = add nsw i64 %250, -1
  %254 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1, i64 %253
  %255 = load i64, ptr %254, align 8
  %256 = srem i64 %252, %255
  %257 = getelementptr inbounds %struct.Operand, ptr %44, i64 %232, i32 1, i64 %253
  %258 = load i64, ptr %257, align 8
  %259 = mul nsw i64 %258, %256
  %260 = getelementptr inbounds double, ptr %251, i64 %259
  %261 = sdiv i64 %252, %255
  %262 = icmp sgt i64 %250, 1
  br i1 %262, label %249, label %263

263:
  %264 = phi ptr [ %246, %243 ], [ %260, %249 ]
  %265 = load double, ptr %264, align 8
  %266 = fptosi double %265 to i32
  %267 = zext i32 %266 to i64
  %268 = icmp eq i64 %235, %267
  br i1 %268, label %269, label %292

269:
  %270 = load ptr, ptr %222, align 8
  %271 = add nsw i64 %245, 1
  %272 = getelementptr inbounds %struct.Turn, ptr %270, i64 %245
  %273 = load ptr, ptr %231, align 8
  br i1 %248, label %274, label %288

274:
  %275 = phi i64 [ %278, %274 ], [ %247, %269 ]
  %276 = phi ptr [ %285, %274 ], [ %273, %269 ]
  %277 = phi i64 [ %286, %274 ], [ %244, %269 ]
  %278 = add nsw i64 %275, -1
  %279 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1, i64 %278
  %280 = load i64, ptr %279, align 8
  %281 = srem i64 %277, %280
  %282 = getelementptr inbounds %struct.Operand, ptr %44, i64 %230, i32 1, i64 %278
  %283 = load i64, ptr %282, align 8
  %284 = mul nsw i64 %283, %281
  %285 = getelementptr inbounds double, ptr %276, i64 %284
  %286 = sdiv i64 %277, %280
  %287 = icmp sgt i64 %275, 1
  br i1 %287, label %274, label %288

288:
  %289 = phi ptr [ %273, %269 ], [ %285, %274 ]
  %290 = load double, ptr %289, align 8
  store double %290, ptr %272, align 8
  %291 = getelementptr inbounds i8, ptr %272, i64 8
  store i64 %244, ptr %291, align 8
  br label %292

292:
  %293 = phi i64 [ %271, %288 ], [ %245, %263 ]
  %294 = add nuw nsw i64 %244, 1
  %295 = load i64, ptr %185, align 8
  %296 = icmp slt i64 %294, %295
  br i1 %296, label %243, label %239

297:
  %298 = load ptr, ptr %222, align 8
  %299 = getelementptr inbounds %struct.Turn, ptr %298, i64 %236
  call void @qsort(ptr noundef %299, i64 noundef %241, i64 noundef 16, ptr noundef nonnull @longer_first)
  br label %300

300:
  %301 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 7, i64 %235
  store i64 %236, ptr %301, align 8
  %302 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 8, i64 %235
  store i64 %240, ptr %302, align 8
  %303 = add nuw nsw i64 %235, 1
  %304 = load i64, ptr @operation, align 8
  %305 = icmp sgt i64 %304, %303
  br i1 %305, label %234, label %306

306:
  %307 = load i64, ptr %185, align 8
  %308 = add nsw i64 %307, 7
  %309 = sdiv i64 %308, 8
  %310 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 5), align 8
  %311 = call i64 @llvm.smin.i64(i64 %309, i64 %310)
  %312 = icmp sgt i64 %311, 1
  %313 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 6), align 8
  %314 = icmp ne ptr %313, null
  %315 = select i1 %312, i1 %314, i1 false
  br i1 %315, label %316, label %319

316:
  %317 = shl i64 %311, 3
  %318 = call noalias ptr @malloc(i64 noundef %317)
  br label %319

319:
  %320 = phi ptr [ %318, %316 ], [ null, %306 ]
  %321 = icmp ne ptr %320, null
  %322 = select i1 %321, i1 %312, i1 false
  br i1 %322, label %323, label %332

323:
  %324 = phi i64 [ %330, %329 ], [ 1, %319 ]
  %325 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 6), align 8
  %326 = getelementptr inbounds i64, ptr %320, i64 %324
  %327 = call i32 %325(ptr noundef nonnull %326, ptr noundef null, ptr noundef nonnull @work, ptr noundef nonnull %8)
  %328 = icmp eq i32 %327, 0
  br i1 %328, label %329, label %332

329:
  %330 = add nuw nsw i64 %324, 1
  %331 = icmp eq i64 %330, %311
  br i1 %331, label %332, label %323

332:
  %333 = phi i64 [ 1, %319 ], [ %324, %323 ], [ %330, %329 ]
  %334 = call ptr @work(ptr noundef nonnull %8)
  %335 = icmp ugt i64 %333, 1
  br i1 %335, label %336, label %344

336:
  %337 = phi i64 [ %342, %336 ], [ 1, %332 ]
  %338 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 7), align 8
  %339 = getelementptr inbounds i64, ptr %320, i64 %337
  %340 = load i64, ptr %339, align 8
  %341 = call i32 %338(i64 noundef %340, ptr noundef null)
  %342 = add nuw nsw i64 %337, 1
  %343 = icmp eq i64 %342, %333
  br i1 %343, label %344, label %336

344:
  call void @free(ptr noundef %320)
  br label %356

345:
  %346 = phi i64 [ %352, %345 ], [ 0, %227 ]
  %347 = getelementptr inbounds ptr, ptr %59, i64 %346
  %348 = load ptr, ptr %347, align 8
  %349 = getelementptr inbounds i8, ptr %348, i64 24
  %350 = load ptr, ptr %349, align 8
  %351 = getelementptr inbounds ptr, ptr %219, i64 %346
  store ptr %350, ptr %351, align 8
  %352 = add nuw nsw i64 %346, 1
  %353 = icmp eq i64 %352, %64
  br i1 %353, label %229, label %345

354:
  %355 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 10
  store i32 1, ptr %355, align 8
  br label %356

356:
  %357 = load ptr, ptr %222, align 8
  call void @free(ptr noundef %357)
  call void @free(ptr noundef %219)
  %358 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 10
  %359 = load i32, ptr %358, align 8
  %360 = icmp eq i32 %359, 0
  br i1 %360, label %370, label %361

361:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %2)
  store i64 32, ptr %2, align 8
  %362 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 1
  store ptr null, ptr %362, align 8
  %363 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 2
  store ptr @.str.1, ptr %363, align 8
  %364 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 3
  store i32 8, ptr %364, align 8
  %365 = getelementptr inbounds i8, ptr %0, i64 16
  %366 = load ptr, ptr %365, align 8
  %367 = getelementptr inbounds i8, ptr %366, i64 48
  %368 = load ptr, ptr %367, align 8
  %369 = call ptr %368(ptr noundef nonnull %2)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %2)
  br label %370

370:
  %371 = phi ptr [ %74, %66 ], [ %169, %167 ], [ null, %203 ], [ %369, %361 ], [ null, %356 ]
  call void @free(ptr noundef %44)
  call void @llvm.lifetime.end.p0(i64 768, ptr nonnull %8)
  br label %372

372:
  %373 = phi ptr [ null, %16 ], [ %41, %33 ], [ %371, %370 ], [ %54, %46 ]
  ret ptr %373
}

declare noalias noundef ptr @malloc(i64 noundef) local_unnamed_addr

declare void @llvm.memset.p0.i64(ptr nocapture writeonly, i8, i64, i1 immarg)

declare void @free(ptr allocptr nocapture noundef) local_unnamed_addr

declare void @qsort(ptr noundef, i64 noundef, i64 noundef, ptr nocapture noundef) local_unnamed_addr

define internal i32 @longer_first(ptr nocapture noundef readonly %0, ptr nocapture noundef readonly %1) {
  %3 = load double, ptr %0, align 8
  %4 = load double, ptr %1, align 8
  %5 = fcmp olt double %3, %4
  br i1 %5, label %18, label %6

6:
  %7 = fcmp ogt double %3, %4
  br i1 %7, label %18, label %8

8:
  %9 = getelementptr inbounds %struct.Turn, ptr %0, i64 0, i32 1
  %10 = load i64, ptr %9, align 8
  %11 = getelementptr inbounds %struct.Turn, ptr %1, i64 0, i32 1
  %12 = load i64, ptr %11, align 8
  %13 = icmp sgt i64 %10, %12
  %14 = zext i1 %13 to i32
  %15 = icmp slt i64 %10, %12
  %16 = sext i1 %15 to i32
  %17 = add nsw i32 %16, %14
  br label %18

18:
  %19 = phi i32 [ %17, %8 ], [ -1, %2 ], [ 1, %6 ]
  ret i32 %19
}

define internal noalias ptr @work(ptr noundef %0) {
  %2 = alloca %struct.Columns, align 8
  %3 = alloca %struct.Share, align 8
  %4 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 9
  %5 = load i64, ptr %4, align 8
  %6 = shl i64 %5, 6
  %7 = add i64 %6, 64
  %8 = tail call noalias ptr @calloc(i64 noundef 1, i64 noundef %7)
  %9 = icmp eq ptr %8, null
  br i1 %9, label %10, label %12

10:
  %11 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 10
  store i32 1, ptr %11, align 8
  br label %35

12:
  %13 = tail call i64 @enter_float_mode()
  call void @llvm.lifetime.start.p0(i64 264, ptr nonnull %2)
  %14 = ptrtoint ptr %8 to i64
  %15 = add i64 %14, 63
  %16 = and i64 %15, -64
  %17 = inttoptr i64 %16 to ptr
  store ptr %17, ptr %2, align 8
  %18 = getelementptr inbounds i8, ptr %2, i64 8
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(64) %18, i8 -1, i64 64, i1 false)
  %19 = load i64, ptr @operation, align 8
  %20 = icmp sgt i64 %19, 0
  br i1 %20, label %21, label %27

21:
  %22 = getelementptr inbounds %struct.Exchange, ptr %3, i64 0, i32 1
  %23 = getelementptr inbounds %struct.Exchange, ptr %3, i64 0, i32 2
  %24 = getelementptr inbounds %struct.Exchange, ptr %3, i64 0, i32 3
  %25 = getelementptr inbounds %struct.Share, ptr %3, i64 0, i32 1
  %26 = getelementptr inbounds %struct.Share, ptr %3, i64 0, i32 2
  br label %28

27:
  call void @leave_float_mode(i64 noundef %13)
  call void @free(ptr noundef %8)
  call void @llvm.lifetime.end.p0(i64 264, ptr nonnull %2)
  br label %35

28:
  %29 = phi i64 [ 0, %21 ], [ %32, %28 ]
  call void @llvm.lifetime.start.p0(i64 48, ptr nonnull %3)
  store ptr @take_lane, ptr %3, align 8
  store ptr @give_lane, ptr %22, align 8
  store ptr @next_time, ptr %23, align 8
  store ptr @give_sample, ptr %24, align 8
  store ptr %0, ptr %25, align 8
  %30 = trunc i64 %29 to i32
  store i32 %30, ptr %26, align 8
  %31 = getelementptr inbounds %struct.Operation, ptr @operation, i64 0, i32 1, i64 %29
  call fastcc void @go_on(ptr noundef nonnull %31, ptr noundef nonnull %2, ptr noundef nonnull %3, i32 noundef 0)
  call void @llvm.lifetime.end.p0(i64 48, ptr nonnull %3)
  %32 = add nuw nsw i64 %29, 1
  %33 = load i64, ptr @operation, align 8
  %34 = icmp sgt i64 %33, %32
  br i1 %34, label %28, label %27

35:
  ret ptr null
}

declare noalias noundef ptr @calloc(i64 noundef, i64 noundef) local_unnamed_addr

define internal i32 @take_lane(ptr nocapture noundef readonly %0, ptr nocapture noundef readonly %1, ptr nocapture noundef %2, i32 noundef %3) {
  %5 = getelementptr inbounds %struct.Share, ptr %0, i64 0, i32 1
  %6 = load ptr, ptr %5, align 8
  %7 = getelementptr inbounds %struct.Share, ptr %0, i64 0, i32 2
  %8 = load i32, ptr %7, align 8
  %9 = sext i32 %8 to i64
  %10 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 7, i64 %9
  %11 = atomicrmw add ptr %10, i64 1 monotonic, align 8
  %12 = load i32, ptr %7, align 8
  %13 = sext i32 %12 to i64
  %14 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 8, i64 %13
  %15 = load i64, ptr %14, align 8
  %16 = icmp slt i64 %11, %15
  br i1 %16, label %17, label %104

17:
  %18 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 6
  %19 = load ptr, ptr %18, align 8
  %20 = getelementptr inbounds %struct.Turn, ptr %19, i64 %11, i32 1
  %21 = load i64, ptr %20, align 8
  %22 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 2), align 8
  %23 = icmp sgt i64 %22, 0
  br i1 %23, label %24, label %27

24:
  %25 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 3
  %26 = sext i32 %3 to i64
  br label %33

27:
  %28 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 5
  %29 = load i64, ptr %28, align 8
  %30 = icmp slt i64 %22, %29
  br i1 %30, label %31, label %63

31:
  %32 = sext i32 %3 to i64
  br label %71

33:
  %34 = phi i64 [ 0, %24 ], [ %61, %54 ]
  %35 = load ptr, ptr %25, align 8
  %36 = getelementptr inbounds %struct.Operand, ptr %35, i64 %34
  %37 = load ptr, ptr %36, align 8
  %38 = load i64, ptr %6, align 8
  %39 = icmp sgt i64 %38, 0
  br i1 %39, label %40, label %54

40:
  %41 = phi i64 [ %44, %40 ], [ %38, %33 ]
  %42 = phi ptr [ %51, %40 ], [ %37, %33 ]
  %43 = phi i64 [ %52, %40 ], [ %21, %33 ]
  %44 = add nsw i64 %41, -1
  %45 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 1, i64 %44
  %46 = load i64, ptr %45, align 8
  %47 = srem i64 %43, %46
  %48 = getelementptr inbounds %struct.Operand, ptr %35, i64 %34, i32 1, i64 %44
  %49 = load i64, ptr %48, align 8
  %50 = mul nsw i64 %49, %47
  %51 = getelementptr inbounds double, ptr %42, i64 %50
  %52 = sdiv i64 %43, %46
  %53 = icmp sgt i64 %41, 1
  br i1 %53, label %40, label %54

54:
  %55 = phi ptr [ %37, %33 ], [ %51, %40 ]
  %56 = load double, ptr %55, align 8
  %57 = load ptr, ptr %2, align 8
  %58 = shl nsw i64 %34, 3
  %59 = add nsw i64 %58, %26
  %60 = getelementptr inbounds double, ptr %57, i64 %59
  store double %56, ptr %60, align 8
  %61 = add nuw nsw i64 %34, 1
  %62 = icmp eq i64 %61, %22
  br i1 %62, label %27, label %33

63:
  %64 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 3), align 8
  %65 = icmp sgt i64 %64, 0
  br i1 %65, label %66, label %80

66:
  %67 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 3
  %68 = add nsw i64 %22, 2
  %69 = add nsw i64 %22, -2
  %70 = sext i32 %3 to i64
  br label %83

71:
  %72 = phi i64 [ %22, %31 ], [ %77, %71 ]
  %73 = load ptr, ptr %2, align 8
  %74 = shl nsw i64 %72, 3
  %75 = add nsw i64 %74, %32
  %76 = getelementptr inbounds double, ptr %73, i64 %75
  store double 0.000000e+00, ptr %76, align 8
  %77 = add nsw i64 %72, 1
  %78 = load i64, ptr %28, align 8
  %79 = icmp slt i64 %77, %78
  br i1 %79, label %71, label %63

80:
  %81 = sext i32 %3 to i64
  %82 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %81
  store i64 %21, ptr %82, align 8
  br label %104

83:
  %84 = phi i64 [ 0, %66 ], [ %101, %100 ]
  %85 = load ptr, ptr %67, align 8
  %86 = getelementptr inbounds %struct.Operand, ptr %85, i64 %68
  %87 = load ptr, ptr %86, align 8
  %88 = getelementptr inbounds double, ptr %87, i64 %84
  %89 = load double, ptr %88, align 8
  %90 = fptosi double %89 to i64
  %91 = icmp sgt i64 %90, -1
  br i1 %91, label %92, label %100

92:
  %93 = load ptr, ptr %2, align 8
  %94 = mul nsw i64 %84, %69
  %95 = add nsw i64 %94, %22
  %96 = add nsw i64 %95, %90
  %97 = shl nsw i64 %96, 3
  %98 = add nsw i64 %97, %70
  %99 = getelementptr inbounds double, ptr %93, i64 %98
  store double 1.000000e+00, ptr %99, align 8
  br label %100

100:
  %101 = add nuw nsw i64 %84, 1
  %102 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 3), align 8
  %103 = icmp slt i64 %101, %102
  br i1 %103, label %83, label %80

104:
  %105 = phi i32 [ 1, %80 ], [ 0, %4 ]
  ret i32 %105
}

define internal void @give_lane(ptr nocapture noundef readonly %0, ptr nocapture noundef readonly %1, ptr nocapture noundef readonly %2, i32 noundef %3) {
  %5 = getelementptr inbounds %struct.Share, ptr %0, i64 0, i32 1
  %6 = load ptr, ptr %5, align 8
  %7 = load ptr, ptr %2, align 8
  %8 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 6
  %9 = load i64, ptr %8, align 8
  %10 = shl nsw i64 %9, 3
  %11 = getelementptr inbounds double, ptr %7, i64 %10
  %12 = sext i32 %3 to i64
  %13 = getelementptr inbounds double, ptr %11, i64 %12
  %14 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 7
  %15 = load i64, ptr %14, align 8
  %16 = icmp sgt i64 %15, 0
  br i1 %16, label %17, label %20

17:
  %18 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 4
  %19 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %12
  br label %30

20:
  %21 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 7
  %22 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 14
  %23 = load i64, ptr %22, align 8
  %24 = icmp sgt i64 %23, 0
  br i1 %24, label %25, label %43

25:
  %26 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %12
  %27 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 5
  %28 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 4
  %29 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %12
  br label %44

30:
  %31 = phi i64 [ 0, %17 ], [ %40, %30 ]
  %32 = shl nsw i64 %31, 3
  %33 = getelementptr inbounds double, ptr %13, i64 %32
  %34 = load double, ptr %33, align 8
  %35 = load ptr, ptr %18, align 8
  %36 = getelementptr inbounds ptr, ptr %35, i64 %31
  %37 = load ptr, ptr %36, align 8
  %38 = load i64, ptr %19, align 8
  %39 = getelementptr inbounds double, ptr %37, i64 %38
  store double %34, ptr %39, align 8
  %40 = add nuw nsw i64 %31, 1
  %41 = load i64, ptr %14, align 8
  %42 = icmp slt i64 %40, %41
  br i1 %42, label %30, label %20

43:
  ret void

44:
  %45 = phi i64 [ 0, %25 ], [ %50, %49 ]
  %46 = load i64, ptr %26, align 8
  %47 = load i64, ptr %27, align 8
  %48 = icmp slt i64 %46, %47
  br i1 %48, label %53, label %49

49:
  %50 = add nuw nsw i64 %45, 1
  %51 = load i64, ptr %22, align 8
  %52 = icmp slt i64 %50, %51
  br i1 %52, label %44, label %43

53:
  %54 = phi i64 [ %66, %53 ], [ %47, %44 ]
  %55 = phi i64 [ %65, %53 ], [ %46, %44 ]
  %56 = load ptr, ptr %28, align 8
  %57 = load i64, ptr %21, align 8
  %58 = add nsw i64 %57, %45
  %59 = getelementptr inbounds ptr, ptr %56, i64 %58
  %60 = load ptr, ptr %59, align 8
  %61 = load i64, ptr %29, align 8
  %62 = mul nsw i64 %61, %54
  %63 = add nsw i64 %62, %55
  %64 = getelementptr inbounds double, ptr %60, i64 %63
  store double 0x7FF8000000000000, ptr %64, align 8
  %65 = add nsw i64 %55, 1
  %66 = load i64, ptr %27, align 8
  %67 = icmp slt i64 %65, %66
  br i1 %67, label %53, label %49
}

define internal double @next_time(ptr nocapture noundef readonly %0, ptr nocapture noundef readonly %1, i32 noundef %2) {
  %4 = getelementptr inbounds %struct.Share, ptr %0, i64 0, i32 1
  %5 = load ptr, ptr %4, align 8
  %6 = sext i32 %2 to i64
  %7 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 4, i64 %6
  %8 = load i64, ptr %7, align 8
  %9 = getelementptr inbounds %struct.Job, ptr %5, i64 0, i32 5
  %10 = load i64, ptr %9, align 8
  %11 = icmp eq i64 %8, %10
  br i1 %11, label %46, label %12

12:
  %13 = getelementptr inbounds %struct.Job, ptr %5, i64 0, i32 3
  %14 = load ptr, ptr %13, align 8
  %15 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 2), align 8
  %16 = add nsw i64 %15, 2
  %17 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 3), align 8
  %18 = icmp sgt i64 %17, 0
  %19 = zext i1 %18 to i64
  %20 = add nsw i64 %16, %19
  %21 = getelementptr inbounds %struct.Operand, ptr %14, i64 %20
  %22 = load ptr, ptr %21, align 8
  %23 = load i64, ptr %5, align 8
  %24 = icmp sgt i64 %23, 0
  br i1 %24, label %25, label %42

25:
  %26 = getelementptr inbounds %struct.Columns, ptr %1, i64 0, i32 1, i64 %6
  %27 = load i64, ptr %26, align 8
  br label %28

28:
  %29 = phi i64 [ %32, %28 ], [ %23, %25 ]
  %30 = phi ptr [ %39, %28 ], [ %22, %25 ]
  %31 = phi i64 [ %40, %28 ], [ %27, %25 ]
  %32 = add nsw i64 %29, -1
  %33 = getelementptr inbounds %struct.Job, ptr %5, i64 0, i32 1, i64 %32
  %34 = load i64, ptr %33, align 8
  %35 = srem i64 %31, %34
  %36 = getelementptr inbounds %struct.Operand, ptr %14, i64 %20, i32 1, i64 %32
  %37 = load i64, ptr %36, align 8
  %38 = mul nsw i64 %37, %35
  %39 = getelementptr inbounds double, ptr %30, i64 %38
  %40 = sdiv i64 %31, %34
  %41 = icmp sgt i64 %29, 1
  br i1 %41, label %28, label %42

42:
  %43 = phi ptr [ %22, %12 ], [ %39, %28 ]
  %44 = getelementptr inbounds double, ptr %43, i64 %8
  %45 = load double, ptr %44, align 8
  br label %46

46:
  %47 = phi double [ %45, %42 ], [ 0x7FF0000000000000, %3 ]
  ret double %47
}

define internal void @give_sample(ptr nocapture noundef readonly %0, ptr nocapture noundef readonly %1, ptr nocapture noundef readonly %2, i32 noundef %3) {
  %5 = getelementptr inbounds %struct.Share, ptr %0, i64 0, i32 1
  %6 = load ptr, ptr %5, align 8
  %7 = load ptr, ptr %2, align 8
  %8 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 13
  %9 = load i64, ptr %8, align 8
  %10 = shl nsw i64 %9, 3
  %11 = getelementptr inbounds double, ptr %7, i64 %10
  %12 = sext i32 %3 to i64
  %13 = getelementptr inbounds double, ptr %11, i64 %12
  %14 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %12
  %15 = load i64, ptr %14, align 8
  %16 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 5
  %17 = load i64, ptr %16, align 8
  %18 = mul nsw i64 %17, %15
  %19 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %12
  %20 = load i64, ptr %19, align 8
  %21 = add nsw i64 %18, %20
  %22 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 14
  %23 = load i64, ptr %22, align 8
  %24 = icmp sgt i64 %23, 0
  br i1 %24, label %25, label %28

25:
  %26 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 4
  %27 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 7
  br label %29

28:
  ret void

29:
  %30 = phi i64 [ 0, %25 ], [ %40, %29 ]
  %31 = shl nsw i64 %30, 3
  %32 = getelementptr inbounds double, ptr %13, i64 %31
  %33 = load double, ptr %32, align 8
  %34 = load ptr, ptr %26, align 8
  %35 = load i64, ptr %27, align 8
  %36 = add nsw i64 %35, %30
  %37 = getelementptr inbounds ptr, ptr %34, i64 %36
  %38 = load ptr, ptr %37, align 8
  %39 = getelementptr inbounds double, ptr %38, i64 %21
  store double %33, ptr %39, align 8
  %40 = add nuw nsw i64 %30, 1
  %41 = load i64, ptr %22, align 8
  %42 = icmp slt i64 %40, %41
  br i1 %42, label %29, label %28
}

declare i64 @llvm.smin.i64(i64, i64)

declare i64 @llvm.smax.i64(i64, i64)

