; Made from driver.c by 'make driver'; sha256 71905c84d09145387dc272bf2026997c4aeedd68c556ad68fbb4715711b8a93c

%struct.Operation = type { i64, [32 x %struct.Program], i64, i64, i64, i64, ptr, ptr }
%struct.Program = type { ptr, ptr, ptr, ptr, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, double, double, [7 x double] }
%struct.Matrices = type { %struct.Exchange, ptr, i64, i64, ptr, ptr, i64, i64, ptr, ptr }
%struct.Exchange = type { ptr, ptr, ptr, ptr }
%struct.Columns = type { ptr, [8 x i64], [8 x double], [8 x i64], [8 x i64] }
%struct.Course = type { ptr, i64, i64, double }
%struct.anon = type { i64, ptr, ptr, i32 }
%struct.Job = type { i64, [24 x i64], i64, i64, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, i64, ptr, [32 x i64], [32 x i64], i64, i32 }
%struct.Operand = type { ptr, [24 x i64] }
%struct.Turn = type { double, i64 }
%struct.Share = type { %struct.Exchange, ptr, i32 }

@operation = dso_local global %struct.Operation zeroinitializer, align 8
@.str = private unnamed_addr constant [28 x i8] c"jaximpact: too few operands\00", align 1
@.str.1 = private unnamed_addr constant [25 x i8] c"jaximpact: out of memory\00", align 1
@.str.2 = private unnamed_addr constant [37 x i8] c"jaximpact: a wrong number of results\00", align 1
@.str.3 = private unnamed_addr constant [41 x i8] c"jaximpact: operands differ in their axes\00", align 1
@.str.4 = private unnamed_addr constant [63 x i8] c"jaximpact computes in float64, but an operand has another type\00", align 1
@.str.5 = private unnamed_addr constant [36 x i8] c"jaximpact: too few or too many axes\00", align 1

define dso_local i64 @run(ptr noundef %0, ptr noundef %1, ptr noundef %2, i64 noundef %3, ptr noundef %4, ptr noundef %5, i64 noundef %6, ptr noundef %7, i64 noundef %8, ptr noundef %9) local_unnamed_addr {
  %11 = alloca %struct.Matrices, align 8
  call void @llvm.lifetime.start.p0(i64 104, ptr nonnull %11)
  store ptr @take_column, ptr %11, align 8
  %12 = getelementptr inbounds %struct.Exchange, ptr %11, i64 0, i32 1
  store ptr @give_column, ptr %12, align 8
  %13 = getelementptr inbounds %struct.Exchange, ptr %11, i64 0, i32 2
  store ptr @next_step, ptr %13, align 8
  %14 = getelementptr inbounds %struct.Exchange, ptr %11, i64 0, i32 3
  store ptr @give_step, ptr %14, align 8
  %15 = getelementptr inbounds %struct.Matrices, ptr %11, i64 0, i32 1
  store ptr %2, ptr %15, align 8
  %16 = getelementptr inbounds %struct.Matrices, ptr %11, i64 0, i32 2
  store i64 %3, ptr %16, align 8
  %17 = getelementptr inbounds %struct.Matrices, ptr %11, i64 0, i32 3
  store i64 0, ptr %17, align 8
  %18 = getelementptr inbounds %struct.Matrices, ptr %11, i64 0, i32 4
  store ptr %4, ptr %18, align 8
  %19 = getelementptr inbounds %struct.Matrices, ptr %11, i64 0, i32 5
  store ptr %5, ptr %19, align 8
  %20 = getelementptr inbounds %struct.Matrices, ptr %11, i64 0, i32 6
  store i64 %6, ptr %20, align 8
  %21 = getelementptr inbounds %struct.Matrices, ptr %11, i64 0, i32 7
  store i64 0, ptr %21, align 8
  %22 = getelementptr inbounds %struct.Matrices, ptr %11, i64 0, i32 8
  store ptr %7, ptr %22, align 8
  %23 = getelementptr inbounds %struct.Matrices, ptr %11, i64 0, i32 9
  store ptr %9, ptr %23, align 8
  %24 = tail call i64 @enter_float_mode()
  %25 = trunc i64 %8 to i32
  call fastcc void @go_on(ptr noundef %0, ptr noundef %1, ptr noundef nonnull %11, i32 noundef %25)
  call void @leave_float_mode(i64 noundef %24)
  %26 = load i64, ptr %21, align 8
  call void @llvm.lifetime.end.p0(i64 104, ptr nonnull %11)
  ret i64 %26
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

define internal double @next_step(ptr nocapture noundef readonly %0, ptr nocapture noundef readonly %1, ptr nocapture noundef readonly %2, i32 noundef %3) {
  %5 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 9
  %6 = load ptr, ptr %5, align 8
  %7 = load ptr, ptr %2, align 8
  %8 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 11
  %9 = load i64, ptr %8, align 8
  %10 = shl nsw i64 %9, 3
  %11 = sext i32 %3 to i64
  %12 = add nsw i64 %10, %11
  %13 = getelementptr inbounds double, ptr %7, i64 %12
  %14 = load double, ptr %13, align 8
  %15 = icmp eq ptr %6, null
  br i1 %15, label %25, label %16

16:
  %17 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %11
  %18 = load i64, ptr %17, align 8
  %19 = icmp eq i64 %18, 0
  br i1 %19, label %25, label %20

20:
  %21 = getelementptr inbounds %struct.Course, ptr %6, i64 0, i32 3
  %22 = load double, ptr %21, align 8
  %23 = fcmp ogt double %14, %22
  %24 = select i1 %23, double %14, double 0x7FF0000000000000
  br label %25

25:
  %26 = phi double [ %24, %20 ], [ 0x7FF0000000000000, %4 ], [ 0.000000e+00, %16 ]
  ret double %26
}

define internal void @give_step(ptr nocapture noundef readonly %0, ptr nocapture noundef readonly %1, ptr nocapture noundef readonly %2, i32 noundef %3) {
  %5 = getelementptr inbounds %struct.Matrices, ptr %0, i64 0, i32 9
  %6 = load ptr, ptr %5, align 8
  %7 = load ptr, ptr %2, align 8
  %8 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 13
  %9 = load i64, ptr %8, align 8
  %10 = shl nsw i64 %9, 3
  %11 = getelementptr inbounds double, ptr %7, i64 %10
  %12 = sext i32 %3 to i64
  %13 = getelementptr inbounds double, ptr %11, i64 %12
  %14 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %12
  %15 = load i64, ptr %14, align 8
  %16 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 12
  %17 = load i64, ptr %16, align 8
  %18 = shl nsw i64 %17, 3
  %19 = add nsw i64 %18, %12
  %20 = getelementptr inbounds double, ptr %7, i64 %19
  %21 = load double, ptr %20, align 8
  %22 = getelementptr inbounds %struct.Course, ptr %6, i64 0, i32 3
  store double %21, ptr %22, align 8
  %23 = add nsw i64 %15, 1
  %24 = getelementptr inbounds %struct.Course, ptr %6, i64 0, i32 2
  store i64 %23, ptr %24, align 8
  %25 = getelementptr inbounds %struct.Course, ptr %6, i64 0, i32 1
  %26 = load i64, ptr %25, align 8
  %27 = icmp slt i64 %15, %26
  br i1 %27, label %28, label %45

28:
  %29 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 14
  %30 = load i64, ptr %29, align 8
  %31 = icmp sgt i64 %30, 0
  br i1 %31, label %32, label %45

32:
  %33 = phi i64 [ %42, %32 ], [ 0, %28 ]
  %34 = shl nsw i64 %33, 3
  %35 = getelementptr inbounds double, ptr %13, i64 %34
  %36 = load double, ptr %35, align 8
  %37 = load ptr, ptr %6, align 8
  %38 = load i64, ptr %25, align 8
  %39 = mul nsw i64 %38, %33
  %40 = add nsw i64 %39, %15
  %41 = getelementptr inbounds double, ptr %37, i64 %40
  store double %36, ptr %41, align 8
  %42 = add nuw nsw i64 %33, 1
  %43 = load i64, ptr %29, align 8
  %44 = icmp slt i64 %42, %43
  br i1 %44, label %32, label %45

45:
  ret void
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
  %102 = tail call double %101(ptr noundef %2, ptr noundef %0, ptr noundef nonnull %1, i32 noundef %96)
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
  br label %386

21:
  %22 = getelementptr inbounds i8, ptr %0, i64 56
  %23 = load i64, ptr %22, align 8
  %24 = add nsw i64 %23, -4
  %25 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 3), align 8
  %26 = icmp sgt i64 %25, 0
  %27 = sext i1 %26 to i64
  %28 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 4), align 8
  %29 = sub i64 %24, %28
  %30 = add i64 %29, %27
  %31 = icmp slt i64 %30, 0
  br i1 %31, label %32, label %41

32:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %7)
  store i64 32, ptr %7, align 8
  %33 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 1
  store ptr null, ptr %33, align 8
  %34 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 2
  store ptr @.str, ptr %34, align 8
  %35 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 3
  store i32 3, ptr %35, align 8
  %36 = getelementptr inbounds i8, ptr %0, i64 16
  %37 = load ptr, ptr %36, align 8
  %38 = getelementptr inbounds i8, ptr %37, i64 48
  %39 = load ptr, ptr %38, align 8
  %40 = call ptr %39(ptr noundef nonnull %7)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %7)
  br label %386

41:
  %42 = mul i64 %23, 200
  %43 = tail call noalias ptr @malloc(i64 noundef %42)
  %44 = icmp eq ptr %43, null
  br i1 %44, label %45, label %54

45:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %6)
  store i64 32, ptr %6, align 8
  %46 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 1
  store ptr null, ptr %46, align 8
  %47 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 2
  store ptr @.str.1, ptr %47, align 8
  %48 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 3
  store i32 8, ptr %48, align 8
  %49 = getelementptr inbounds i8, ptr %0, i64 16
  %50 = load ptr, ptr %49, align 8
  %51 = getelementptr inbounds i8, ptr %50, i64 48
  %52 = load ptr, ptr %51, align 8
  %53 = call ptr %52(ptr noundef nonnull %6)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %6)
  br label %386

54:
  call void @llvm.lifetime.start.p0(i64 824, ptr nonnull %8)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(824) %8, i8 0, i64 824, i1 false)
  %55 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 3
  store i64 %30, ptr %55, align 8
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
  br label %384

75:
  %76 = icmp sgt i64 %23, 0
  br i1 %76, label %77, label %169

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
  %86 = phi i64 [ %88, %85 ], [ 0, %54 ]
  %87 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1, i64 %86
  store i64 1, ptr %87, align 8
  %88 = add nuw nsw i64 %86, 1
  %89 = icmp eq i64 %88, 24
  br i1 %89, label %75, label %85

90:
  %91 = add nuw nsw i64 %98, 1
  %92 = icmp slt i64 %91, %23
  %93 = icmp eq i64 %91, %23
  br i1 %93, label %169, label %94

94:
  %95 = phi i1 [ true, %77 ], [ %92, %90 ]
  %96 = phi ptr [ undef, %77 ], [ %168, %90 ]
  %97 = phi i64 [ -1, %77 ], [ %167, %90 ]
  %98 = phi i64 [ 0, %77 ], [ %91, %90 ]
  %99 = icmp ult i64 %98, 2
  %100 = load i64, ptr %55, align 8
  %101 = add nsw i64 %100, 4
  %102 = icmp sge i64 %98, %101
  %103 = select i1 %99, i1 true, i1 %102
  %104 = zext i1 %103 to i64
  %105 = getelementptr inbounds ptr, ptr %57, i64 %98
  %106 = load ptr, ptr %105, align 8
  %107 = getelementptr inbounds %struct.Operand, ptr %43, i64 %98
  %108 = getelementptr inbounds i8, ptr %106, i64 32
  %109 = load i64, ptr %108, align 8
  %110 = getelementptr inbounds i8, ptr %106, i64 40
  %111 = load ptr, ptr %110, align 8
  %112 = getelementptr inbounds i8, ptr %106, i64 16
  %113 = load i32, ptr %112, align 4
  %114 = icmp eq i32 %113, 12
  br i1 %114, label %115, label %145

115:
  %116 = icmp slt i64 %109, %104
  br i1 %116, label %145, label %117

117:
  %118 = sub nsw i64 %109, %104
  %119 = icmp sgt i64 %118, 24
  br i1 %119, label %145, label %120

120:
  %121 = getelementptr inbounds i8, ptr %106, i64 24
  %122 = load ptr, ptr %121, align 8
  store ptr %122, ptr %107, align 8
  store i64 %118, ptr %8, align 8
  %123 = icmp sgt i64 %109, 0
  br i1 %123, label %124, label %145

124:
  %125 = phi i64 [ %127, %140 ], [ %109, %120 ]
  %126 = phi i64 [ %143, %140 ], [ 1, %120 ]
  %127 = add nsw i64 %125, -1
  %128 = load i64, ptr %8, align 8
  %129 = icmp sgt i64 %125, %128
  br i1 %129, label %140, label %130

130:
  %131 = getelementptr inbounds i64, ptr %111, i64 %127
  %132 = load i64, ptr %131, align 8
  %133 = icmp eq i64 %132, 1
  %134 = select i1 %133, i64 0, i64 %126
  %135 = getelementptr inbounds %struct.Operand, ptr %43, i64 %98, i32 1, i64 %127
  store i64 %134, ptr %135, align 8
  %136 = load i64, ptr %131, align 8
  %137 = icmp eq i64 %136, 1
  br i1 %137, label %140, label %138

138:
  %139 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1, i64 %127
  store i64 %136, ptr %139, align 8
  br label %140

140:
  %141 = getelementptr inbounds i64, ptr %111, i64 %127
  %142 = load i64, ptr %141, align 8
  %143 = mul nsw i64 %142, %126
  %144 = icmp sgt i64 %125, 1
  br i1 %144, label %124, label %145

145:
  %146 = phi i1 [ false, %94 ], [ false, %115 ], [ false, %117 ], [ true, %120 ], [ true, %140 ]
  %147 = phi ptr [ @.str.4, %94 ], [ @.str.5, %115 ], [ @.str.5, %117 ], [ null, %120 ], [ null, %140 ]
  br i1 %146, label %153, label %148

148:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %4)
  store i64 32, ptr %4, align 8
  store ptr null, ptr %78, align 8
  store ptr %147, ptr %79, align 8
  store i32 3, ptr %80, align 8
  %149 = load ptr, ptr %81, align 8
  %150 = getelementptr inbounds i8, ptr %149, i64 48
  %151 = load ptr, ptr %150, align 8
  %152 = call ptr %151(ptr noundef nonnull %4)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %4)
  br label %165

153:
  %154 = icmp slt i64 %97, 0
  %155 = load i64, ptr %8, align 8
  %156 = icmp eq i64 %155, %97
  %157 = select i1 %154, i1 true, i1 %156
  br i1 %157, label %163, label %158

158:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %3)
  store i64 32, ptr %3, align 8
  store ptr null, ptr %82, align 8
  store ptr @.str.3, ptr %83, align 8
  store i32 3, ptr %84, align 8
  %159 = load ptr, ptr %81, align 8
  %160 = getelementptr inbounds i8, ptr %159, i64 48
  %161 = load ptr, ptr %160, align 8
  %162 = call ptr %161(ptr noundef nonnull %3)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %3)
  br label %165

163:
  %164 = load i64, ptr %8, align 8
  br label %165

165:
  %166 = phi i1 [ true, %163 ], [ false, %158 ], [ false, %148 ]
  %167 = phi i64 [ %164, %163 ], [ %97, %158 ], [ %97, %148 ]
  %168 = phi ptr [ %96, %163 ], [ %162, %158 ], [ %152, %148 ]
  br i1 %166, label %90, label %169

169:
  %170 = phi i1 [ %76, %75 ], [ %95, %165 ], [ %92, %90 ]
  %171 = phi ptr [ undef, %75 ], [ %168, %90 ], [ %168, %165 ]
  br i1 %170, label %384, label %172

172:
  %173 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 4), align 8
  %174 = icmp eq i64 %173, 0
  br i1 %174, label %185, label %175

175:
  %176 = add nsw i64 %23, -1
  %177 = getelementptr inbounds ptr, ptr %57, i64 %176
  %178 = load ptr, ptr %177, align 8
  %179 = getelementptr inbounds i8, ptr %178, i64 40
  %180 = load ptr, ptr %179, align 8
  %181 = load i64, ptr %8, align 8
  %182 = getelementptr inbounds i64, ptr %180, i64 %181
  %183 = load i64, ptr %182, align 8
  %184 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 12
  store i64 %183, ptr %184, align 8
  br label %185

185:
  %186 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 4
  store ptr %43, ptr %186, align 8
  %187 = getelementptr inbounds %struct.Operand, ptr %43, i64 1
  %188 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 5
  store ptr %187, ptr %188, align 8
  %189 = getelementptr inbounds %struct.Operand, ptr %43, i64 2
  %190 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 6
  store ptr %189, ptr %190, align 8
  %191 = load i64, ptr %55, align 8
  %192 = getelementptr inbounds %struct.Operand, ptr %189, i64 %191
  %193 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 7
  store ptr %192, ptr %193, align 8
  %194 = getelementptr inbounds %struct.Operand, ptr %192, i64 1
  %195 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 8
  store ptr %194, ptr %195, align 8
  %196 = getelementptr inbounds %struct.Operand, ptr %194, i64 1
  %197 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 9
  store ptr %196, ptr %197, align 8
  %198 = getelementptr inbounds %struct.Operand, ptr %43, i64 %23
  %199 = getelementptr inbounds %struct.Operand, ptr %198, i64 -1
  %200 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 10
  store ptr %199, ptr %200, align 8
  %201 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 2
  store i64 1, ptr %201, align 8
  %202 = load i64, ptr %8, align 8
  %203 = icmp sgt i64 %202, 0
  br i1 %203, label %210, label %204

204:
  %205 = load i64, ptr @operation, align 8
  %206 = icmp sgt i64 %205, 0
  br i1 %206, label %207, label %219

207:
  %208 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 16
  %209 = load i64, ptr %208, align 8
  br label %222

210:
  %211 = phi i64 [ %215, %210 ], [ 1, %185 ]
  %212 = phi i64 [ %216, %210 ], [ 0, %185 ]
  %213 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1, i64 %212
  %214 = load i64, ptr %213, align 8
  %215 = mul nsw i64 %214, %211
  store i64 %215, ptr %201, align 8
  %216 = add nuw nsw i64 %212, 1
  %217 = icmp eq i64 %216, %202
  br i1 %217, label %204, label %210

218:
  store i64 %229, ptr %208, align 8
  br label %219

219:
  %220 = load i64, ptr %201, align 8
  %221 = icmp eq i64 %220, 0
  br i1 %221, label %384, label %233

222:
  %223 = phi i64 [ %209, %207 ], [ %229, %222 ]
  %224 = phi i64 [ %209, %207 ], [ %230, %222 ]
  %225 = phi i64 [ 0, %207 ], [ %231, %222 ]
  %226 = getelementptr inbounds %struct.Operation, ptr @operation, i64 0, i32 1, i64 %225, i32 4
  %227 = load i64, ptr %226, align 8
  %228 = icmp sgt i64 %227, %224
  %229 = select i1 %228, i64 %227, i64 %223
  %230 = call i64 @llvm.smax.i64(i64 %227, i64 %224)
  %231 = add nuw nsw i64 %225, 1
  %232 = icmp eq i64 %231, %205
  br i1 %232, label %218, label %222

233:
  %234 = shl i64 %64, 3
  %235 = call noalias ptr @malloc(i64 noundef %234)
  %236 = shl i64 %220, 4
  %237 = call noalias ptr @malloc(i64 noundef %236)
  %238 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 13
  store ptr %237, ptr %238, align 8
  %239 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 11
  store ptr %235, ptr %239, align 8
  %240 = icmp eq ptr %235, null
  %241 = icmp eq ptr %237, null
  %242 = or i1 %240, %241
  br i1 %242, label %368, label %243

243:
  %244 = icmp sgt i64 %64, 0
  br i1 %244, label %359, label %245

245:
  br i1 %206, label %246, label %320

246:
  %247 = phi i64 [ %317, %314 ], [ 0, %245 ]
  %248 = phi i64 [ %252, %314 ], [ 0, %245 ]
  %249 = load i64, ptr %201, align 8
  %250 = icmp sgt i64 %249, 0
  br i1 %250, label %255, label %251

251:
  %252 = phi i64 [ %248, %246 ], [ %307, %306 ]
  %253 = sub nsw i64 %252, %248
  %254 = icmp sgt i64 %253, 8
  br i1 %254, label %311, label %314

255:
  %256 = phi i64 [ %308, %306 ], [ 0, %246 ]
  %257 = phi i64 [ %307, %306 ], [ %248, %246 ]
  %258 = load ptr, ptr %195, align 8
  %259 = load ptr, ptr %258, align 8
  %260 = load i64, ptr %8, align 8
  %261 = icmp sgt i64 %260, 0
  br i1 %261, label %262, label %276

262:
  %263 = phi i64 [ %266, %262 ], [ %260, %255 ]
  %264 = phi ptr [ %273, %262 ], [ %259, %255 ]
  %265 = phi i64 [ %274, %262 ], [ %256, %255 ]
  %266 = add nsw i64 %263, -1
  %267 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1, i64 %266
  %268 = load i64, ptr %267, align 8
  %269 = srem i64 %265, %268
  %270 = getelementptr inbounds %struct.Operand, ptr %258, i64 0, i32 1, i64 %266
  %271 = load i64, ptr %270, align 8
  %272 = mul nsw i64 %271, %269
  %273 = getelementptr inbounds double, ptr %264, i64 %272
  %274 = sdiv i64 %265, %268
  %275 = icmp sgt i64 %263, 1
  br i1 %275, label %262, label %276

276:
  %277 = phi ptr [ %259, %255 ], [ %273, %262 ]
  %278 = load double, ptr %277, align 8
  %279 = fptosi double %278 to i32
  %280 = zext i32 %279 to i64
  %281 = icmp eq i64 %247, %280
  br i1 %281, label %282, label %306

282:
  %283 = load ptr, ptr %238, align 8
  %284 = add nsw i64 %257, 1
  %285 = getelementptr inbounds %struct.Turn, ptr %283, i64 %257
  %286 = load ptr, ptr %193, align 8
  %287 = load ptr, ptr %286, align 8
  br i1 %261, label %288, label %302

288:
  %289 = phi i64 [ %292, %288 ], [ %260, %282 ]
  %290 = phi ptr [ %299, %288 ], [ %287, %282 ]
  %291 = phi i64 [ %300, %288 ], [ %256, %282 ]
  %292 = add nsw i64 %289, -1
  %293 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1, i64 %292
  %294 = load i64, ptr %293, align 8
  %295 = srem i64 %291, %294
  %296 = getelementptr inbounds %struct.Operand, ptr %286, i64 0, i32 1, i64 %292
  %297 = load i64, ptr %296, align 8
  %298 = mul nsw i64 %297, %295
  %299 = getelementptr inbounds double, ptr %290, i64 %298
  %300 = sdiv i64 %291, %294
  %301 = icmp sgt i64 %289, 1
  br i1 %301, label %288, label %302

302:
  %303 = phi ptr [ %287, %282 ], [ %299, %288 ]
  %304 = load double, ptr %303, align 8
  store double %304, ptr %285, align 8
  %305 = getelementptr inbounds i8, ptr %285, i64 8
  store i64 %256, ptr %305, align 8
  br label %306

306:
  %307 = phi i64 [ %284, %302 ], [ %257, %276 ]
  %308 = add nuw nsw i64 %256, 1
  %309 = load i64, ptr %201, align 8
  %310 = icmp slt i64 %308, %309
  br i1 %310, label %255, label %251

311:
  %312 = load ptr, ptr %238, align 8
  %313 = getelementptr inbounds %struct.Turn, ptr %312, i64 %248
  call void @qsort(ptr noundef %313, i64 noundef %253, i64 noundef 16, ptr noundef nonnull @longer_first)
  br label %314

314:
  %315 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 14, i64 %247
  store i64 %248, ptr %315, align 8
  %316 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 15, i64 %247
  store i64 %252, ptr %316, align 8
  %317 = add nuw nsw i64 %247, 1
  %318 = load i64, ptr @operation, align 8
  %319 = icmp sgt i64 %318, %317
  br i1 %319, label %246, label %320

320:
  %321 = load i64, ptr %201, align 8
  %322 = add nsw i64 %321, 7
  %323 = sdiv i64 %322, 8
  %324 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 5), align 8
  %325 = call i64 @llvm.smin.i64(i64 %323, i64 %324)
  %326 = icmp sgt i64 %325, 1
  %327 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 6), align 8
  %328 = icmp ne ptr %327, null
  %329 = select i1 %326, i1 %328, i1 false
  br i1 %329, label %330, label %333

330:
  %331 = shl i64 %325, 3
  %332 = call noalias ptr @malloc(i64 noundef %331)
  br label %333

333:
  %334 = phi ptr [ %332, %330 ], [ null, %320 ]
  %335 = icmp ne ptr %334, null
  %336 = select i1 %335, i1 %326, i1 false
  br i1 %336, label %337, label %346

337:
  %338 = phi i64 [ %344, %343 ], [ 1, %333 ]
  %339 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 6), align 8
  %340 = getelementptr inbounds i64, ptr %334, i64 %338
  %341 = call i32 %339(ptr noundef nonnull %340, ptr noundef null, ptr noundef nonnull @work, ptr noundef nonnull %8)
  %342 = icmp eq i32 %341, 0
  br i1 %342, label %343, label %346

343:
  %344 = add nuw nsw i64 %338, 1
  %345 = icmp eq i64 %344, %325
  br i1 %345, label %346, label %337

346:
  %347 = phi i64 [ 1, %333 ], [ %338, %337 ], [ %344, %343 ]
  %348 = call ptr @work(ptr noundef nonnull %8)
  %349 = icmp ugt i64 %347, 1
  br i1 %349, label %350, label %358

350:
  %351 = phi i64 [ %356, %350 ], [ 1, %346 ]
  %352 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 7), align 8
  %353 = getelementptr inbounds i64, ptr %334, i64 %351
  %354 = load i64, ptr %353, align 8
  %355 = call i32 %352(i64 noundef %354, ptr noundef null)
  %356 = add nuw nsw i64 %351, 1
  %357 = icmp eq i64 %356, %347
  br i1 %357, label %358, label %350

358:
  call void @free(ptr noundef %334)
  br label %370

359:
  %360 = phi i64 [ %366, %359 ], [ 0, %243 ]
  %361 = getelementptr inbounds ptr, ptr %59, i64 %360
  %362 = load ptr, ptr %361, align 8
  %363 = getelementptr inbounds i8, ptr %362, i64 24
  %364 = load ptr, ptr %363, align 8
  %365 = getelementptr inbounds ptr, ptr %235, i64 %360
  store ptr %364, ptr %365, align 8
  %366 = add nuw nsw i64 %360, 1
  %367 = icmp eq i64 %366, %64
  br i1 %367, label %245, label %359

368:
  %369 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 17
  store i32 1, ptr %369, align 8
  br label %370

370:
  %371 = load ptr, ptr %238, align 8
  call void @free(ptr noundef %371)
  call void @free(ptr noundef %235)
  %372 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 17
  %373 = load i32, ptr %372, align 8
  %374 = icmp eq i32 %373, 0
  br i1 %374, label %384, label %375

375:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %2)
  store i64 32, ptr %2, align 8
  %376 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 1
  store ptr null, ptr %376, align 8
  %377 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 2
  store ptr @.str.1, ptr %377, align 8
  %378 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 3
  store i32 8, ptr %378, align 8
  %379 = getelementptr inbounds i8, ptr %0, i64 16
  %380 = load ptr, ptr %379, align 8
  %381 = getelementptr inbounds i8, ptr %380, i64 48
  %382 = load ptr, ptr %381, align 8
  %383 = call ptr %382(ptr noundef nonnull %2)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %2)
  br label %384

384:
  %385 = phi ptr [ %74, %66 ], [ %171, %169 ], [ null, %219 ], [ %383, %375 ], [ null, %370 ]
  call void @free(ptr noundef %43)
  call void @llvm.lifetime.end.p0(i64 824, ptr nonnull %8)
  br label %386

386:
  %387 = phi ptr [ null, %16 ], [ %40, %32 ], [ %385, %384 ], [ %53, %45 ]
  ret ptr %387
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
  %4 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 16
  %5 = load i64, ptr %4, align 8
  %6 = shl i64 %5, 6
  %7 = add i64 %6, 64
  %8 = tail call noalias ptr @calloc(i64 noundef 1, i64 noundef %7)
  %9 = icmp eq ptr %8, null
  br i1 %9, label %10, label %12

10:
  %11 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 17
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
  %10 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 14, i64 %9
  %11 = atomicrmw add ptr %10, i64 1 monotonic, align 8
  %12 = load i32, ptr %7, align 8
  %13 = sext i32 %12 to i64
  %14 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 15, i64 %13
  %15 = load i64, ptr %14, align 8
  %16 = icmp slt i64 %11, %15
  br i1 %16, label %17, label %132

17:
  %18 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 13
  %19 = load ptr, ptr %18, align 8
  %20 = getelementptr inbounds %struct.Turn, ptr %19, i64 %11, i32 1
  %21 = load i64, ptr %20, align 8
  %22 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 2), align 8
  %23 = icmp sgt i64 %22, 0
  br i1 %23, label %24, label %27

24:
  %25 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 4
  %26 = sext i32 %3 to i64
  br label %35

27:
  %28 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 3
  %29 = load i64, ptr %28, align 8
  %30 = icmp sgt i64 %29, 0
  br i1 %30, label %31, label %47

31:
  %32 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 5
  %33 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 6
  %34 = sext i32 %3 to i64
  br label %53

35:
  %36 = phi i64 [ 0, %24 ], [ %45, %35 ]
  %37 = load ptr, ptr %25, align 8
  %38 = load ptr, ptr %37, align 8
  %39 = getelementptr inbounds double, ptr %38, i64 %36
  %40 = load double, ptr %39, align 8
  %41 = load ptr, ptr %2, align 8
  %42 = shl nsw i64 %36, 3
  %43 = add nsw i64 %42, %26
  %44 = getelementptr inbounds double, ptr %41, i64 %43
  store double %40, ptr %44, align 8
  %45 = add nuw nsw i64 %36, 1
  %46 = icmp eq i64 %45, %22
  br i1 %46, label %27, label %35

47:
  %48 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 5
  %49 = load i64, ptr %48, align 8
  %50 = icmp slt i64 %22, %49
  br i1 %50, label %51, label %89

51:
  %52 = sext i32 %3 to i64
  br label %96

53:
  %54 = phi i64 [ 0, %31 ], [ %86, %79 ]
  %55 = load ptr, ptr %32, align 8
  %56 = load ptr, ptr %55, align 8
  %57 = getelementptr inbounds double, ptr %56, i64 %54
  %58 = load double, ptr %57, align 8
  %59 = fptosi double %58 to i64
  %60 = load ptr, ptr %33, align 8
  %61 = getelementptr inbounds %struct.Operand, ptr %60, i64 %54
  %62 = load ptr, ptr %61, align 8
  %63 = load i64, ptr %6, align 8
  %64 = icmp sgt i64 %63, 0
  br i1 %64, label %65, label %79

65:
  %66 = phi i64 [ %69, %65 ], [ %63, %53 ]
  %67 = phi ptr [ %76, %65 ], [ %62, %53 ]
  %68 = phi i64 [ %77, %65 ], [ %21, %53 ]
  %69 = add nsw i64 %66, -1
  %70 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 1, i64 %69
  %71 = load i64, ptr %70, align 8
  %72 = srem i64 %68, %71
  %73 = getelementptr inbounds %struct.Operand, ptr %60, i64 %54, i32 1, i64 %69
  %74 = load i64, ptr %73, align 8
  %75 = mul nsw i64 %74, %72
  %76 = getelementptr inbounds double, ptr %67, i64 %75
  %77 = sdiv i64 %68, %71
  %78 = icmp sgt i64 %66, 1
  br i1 %78, label %65, label %79

79:
  %80 = phi ptr [ %62, %53 ], [ %76, %65 ]
  %81 = load double, ptr %80, align 8
  %82 = load ptr, ptr %2, align 8
  %83 = shl nsw i64 %59, 3
  %84 = add nsw i64 %83, %34
  %85 = getelementptr inbounds double, ptr %82, i64 %84
  store double %81, ptr %85, align 8
  %86 = add nuw nsw i64 %54, 1
  %87 = load i64, ptr %28, align 8
  %88 = icmp slt i64 %86, %87
  br i1 %88, label %53, label %47

89:
  %90 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 5
  %91 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 3), align 8
  %92 = icmp sgt i64 %91, 0
  br i1 %92, label %93, label %105

93:
  %94 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 9
  %95 = sext i32 %3 to i64
  br label %108

96:
  %97 = phi i64 [ %22, %51 ], [ %102, %96 ]
  %98 = load ptr, ptr %2, align 8
  %99 = shl nsw i64 %97, 3
  %100 = add nsw i64 %99, %52
  %101 = getelementptr inbounds double, ptr %98, i64 %100
  store double 0.000000e+00, ptr %101, align 8
  %102 = add nsw i64 %97, 1
  %103 = load i64, ptr %48, align 8
  %104 = icmp slt i64 %102, %103
  br i1 %104, label %96, label %89

105:
  %106 = sext i32 %3 to i64
  %107 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %106
  store i64 %21, ptr %107, align 8
  br label %132

108:
  %109 = phi i64 [ %91, %93 ], [ %130, %128 ]
  %110 = phi i64 [ 0, %93 ], [ %129, %128 ]
  %111 = load ptr, ptr %94, align 8
  %112 = load ptr, ptr %111, align 8
  %113 = getelementptr inbounds double, ptr %112, i64 %110
  %114 = load double, ptr %113, align 8
  %115 = fptosi double %114 to i64
  %116 = icmp sgt i64 %115, -1
  br i1 %116, label %117, label %128

117:
  %118 = load i64, ptr %90, align 8
  %119 = sub nsw i64 %118, %22
  %120 = sdiv i64 %119, %109
  %121 = load ptr, ptr %2, align 8
  %122 = mul nsw i64 %120, %110
  %123 = add i64 %22, %115
  %124 = add i64 %123, %122
  %125 = shl nsw i64 %124, 3
  %126 = add nsw i64 %125, %95
  %127 = getelementptr inbounds double, ptr %121, i64 %126
  store double 1.000000e+00, ptr %127, align 8
  br label %128

128:
  %129 = add nuw nsw i64 %110, 1
  %130 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 3), align 8
  %131 = icmp slt i64 %129, %130
  br i1 %131, label %108, label %105

132:
  %133 = phi i32 [ 1, %105 ], [ 0, %4 ]
  ret i32 %133
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
  %18 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 11
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
  %27 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 12
  %28 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 11
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

define internal double @next_time(ptr nocapture noundef readonly %0, ptr nocapture readnone %1, ptr nocapture noundef readonly %2, i32 noundef %3) {
  %5 = getelementptr inbounds %struct.Share, ptr %0, i64 0, i32 1
  %6 = load ptr, ptr %5, align 8
  %7 = sext i32 %3 to i64
  %8 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %7
  %9 = load i64, ptr %8, align 8
  %10 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 12
  %11 = load i64, ptr %10, align 8
  %12 = icmp eq i64 %9, %11
  br i1 %12, label %40, label %13

13:
  %14 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 10
  %15 = load ptr, ptr %14, align 8
  %16 = load ptr, ptr %15, align 8
  %17 = load i64, ptr %6, align 8
  %18 = icmp sgt i64 %17, 0
  br i1 %18, label %19, label %36

19:
  %20 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %7
  %21 = load i64, ptr %20, align 8
  br label %22

22:
  %23 = phi i64 [ %26, %22 ], [ %17, %19 ]
  %24 = phi ptr [ %33, %22 ], [ %16, %19 ]
  %25 = phi i64 [ %34, %22 ], [ %21, %19 ]
  %26 = add nsw i64 %23, -1
  %27 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 1, i64 %26
  %28 = load i64, ptr %27, align 8
  %29 = srem i64 %25, %28
  %30 = getelementptr inbounds %struct.Operand, ptr %15, i64 0, i32 1, i64 %26
  %31 = load i64, ptr %30, align 8
  %32 = mul nsw i64 %31, %29
  %33 = getelementptr inbounds double, ptr %24, i64 %32
  %34 = sdiv i64 %25, %28
  %35 = icmp sgt i64 %23, 1
  br i1 %35, label %22, label %36

36:
  %37 = phi ptr [ %16, %13 ], [ %33, %22 ]
  %38 = getelementptr inbounds double, ptr %37, i64 %9
  %39 = load double, ptr %38, align 8
  br label %40

40:
  %41 = phi double [ %39, %36 ], [ 0x7FF0000000000000, %4 ]
  ret double %41
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
  %16 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 12
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
  %26 = getelementptr inbounds %struct.Job, ptr %6, i64 0, i32 11
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

