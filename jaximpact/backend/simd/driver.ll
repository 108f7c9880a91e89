; Made from driver.c by 'make driver'; sha256 4fc3097699e859ee76a1a6dd743f6415b61f479a0db8f1c849dbef95159234dc

%struct.Operation = type { i64, [32 x %struct.Program], i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr }
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
@.str.4 = private unnamed_addr constant [36 x i8] c"jaximpact: a wrong number of inputs\00", align 1
@.str.5 = private unnamed_addr constant [61 x i8] c"jaximpact: a result is not float64 of the shape of the lanes\00", align 1
@.str.6 = private unnamed_addr constant [63 x i8] c"jaximpact computes in float64, but an operand has another type\00", align 1
@.str.7 = private unnamed_addr constant [70 x i8] c"jaximpact: impacts take arrays of at most 24 axes, with those of vmap\00", align 1
@.str.8 = private unnamed_addr constant [37 x i8] c"jaximpact: operands do not broadcast\00", align 1

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
  %8 = alloca %struct.anon, align 8
  %9 = alloca %struct.anon, align 8
  %10 = alloca %struct.Job, align 8
  %11 = getelementptr inbounds i8, ptr %0, i64 8
  %12 = load ptr, ptr %11, align 8
  %13 = icmp eq ptr %12, null
  br i1 %13, label %23, label %14

14:
  %15 = getelementptr inbounds i8, ptr %12, i64 8
  %16 = load i32, ptr %15, align 4
  %17 = icmp eq i32 %16, 1
  br i1 %17, label %18, label %23

18:
  %19 = getelementptr inbounds i8, ptr %12, i64 24
  %20 = load ptr, ptr %19, align 8
  %21 = getelementptr inbounds i8, ptr %20, i64 24
  store i32 0, ptr %21, align 4
  %22 = getelementptr inbounds i8, ptr %20, i64 28
  store i32 1, ptr %22, align 4
  br label %480

23:
  %24 = getelementptr inbounds i8, ptr %0, i64 56
  %25 = load i64, ptr %24, align 8
  %26 = add nsw i64 %25, -4
  %27 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 3), align 8
  %28 = icmp sgt i64 %27, 0
  %29 = sext i1 %28 to i64
  %30 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 4), align 8
  %31 = sub i64 %26, %30
  %32 = add i64 %31, %29
  %33 = icmp slt i64 %32, 0
  br i1 %33, label %34, label %43

34:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %9)
  store i64 32, ptr %9, align 8
  %35 = getelementptr inbounds %struct.anon, ptr %9, i64 0, i32 1
  store ptr null, ptr %35, align 8
  %36 = getelementptr inbounds %struct.anon, ptr %9, i64 0, i32 2
  store ptr @.str, ptr %36, align 8
  %37 = getelementptr inbounds %struct.anon, ptr %9, i64 0, i32 3
  store i32 3, ptr %37, align 8
  %38 = getelementptr inbounds i8, ptr %0, i64 16
  %39 = load ptr, ptr %38, align 8
  %40 = getelementptr inbounds i8, ptr %39, i64 48
  %41 = load ptr, ptr %40, align 8
  %42 = call ptr %41(ptr noundef nonnull %9)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %9)
  br label %480

43:
  %44 = mul i64 %25, 200
  %45 = tail call noalias ptr @malloc(i64 noundef %44)
  %46 = icmp eq ptr %45, null
  br i1 %46, label %47, label %56

47:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %8)
  store i64 32, ptr %8, align 8
  %48 = getelementptr inbounds %struct.anon, ptr %8, i64 0, i32 1
  store ptr null, ptr %48, align 8
  %49 = getelementptr inbounds %struct.anon, ptr %8, i64 0, i32 2
  store ptr @.str.1, ptr %49, align 8
  %50 = getelementptr inbounds %struct.anon, ptr %8, i64 0, i32 3
  store i32 8, ptr %50, align 8
  %51 = getelementptr inbounds i8, ptr %0, i64 16
  %52 = load ptr, ptr %51, align 8
  %53 = getelementptr inbounds i8, ptr %52, i64 48
  %54 = load ptr, ptr %53, align 8
  %55 = call ptr %54(ptr noundef nonnull %8)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %8)
  br label %480

56:
  call void @llvm.lifetime.start.p0(i64 824, ptr nonnull %10)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(824) %10, i8 0, i64 824, i1 false)
  %57 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 3
  store i64 %32, ptr %57, align 8
  %58 = getelementptr inbounds i8, ptr %0, i64 72
  %59 = load ptr, ptr %58, align 8
  %60 = getelementptr inbounds i8, ptr %0, i64 112
  %61 = load ptr, ptr %60, align 8
  %62 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 1, i64 0, i32 7), align 8
  %63 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 1, i64 0, i32 14), align 8
  %64 = getelementptr inbounds i8, ptr %0, i64 96
  %65 = load i64, ptr %64, align 8
  %66 = add nsw i64 %63, %62
  %67 = icmp eq i64 %65, %66
  br i1 %67, label %87, label %68

68:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %7)
  store i64 32, ptr %7, align 8
  %69 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 1
  store ptr null, ptr %69, align 8
  %70 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 2
  store ptr @.str.2, ptr %70, align 8
  %71 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 3
  store i32 3, ptr %71, align 8
  %72 = getelementptr inbounds i8, ptr %0, i64 16
  %73 = load ptr, ptr %72, align 8
  %74 = getelementptr inbounds i8, ptr %73, i64 48
  %75 = load ptr, ptr %74, align 8
  %76 = call ptr %75(ptr noundef nonnull %7)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %7)
  br label %478

77:
  %78 = icmp sgt i64 %25, 0
  br i1 %78, label %79, label %176

79:
  %80 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 1
  %81 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 2
  %82 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 3
  %83 = getelementptr inbounds i8, ptr %0, i64 16
  %84 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 1
  %85 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 2
  %86 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 3
  br label %96

87:
  %88 = phi i64 [ %90, %87 ], [ 0, %56 ]
  %89 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 1, i64 %88
  store i64 1, ptr %89, align 8
  %90 = add nuw nsw i64 %88, 1
  %91 = icmp eq i64 %90, 24
  br i1 %91, label %77, label %87

92:
  %93 = add nuw nsw i64 %100, 1
  %94 = icmp slt i64 %93, %25
  %95 = icmp eq i64 %93, %25
  br i1 %95, label %176, label %96

96:
  %97 = phi i1 [ true, %79 ], [ %94, %92 ]
  %98 = phi ptr [ undef, %79 ], [ %175, %92 ]
  %99 = phi i64 [ -1, %79 ], [ %174, %92 ]
  %100 = phi i64 [ 0, %79 ], [ %93, %92 ]
  %101 = icmp ult i64 %100, 2
  %102 = load i64, ptr %57, align 8
  %103 = add nsw i64 %102, 4
  %104 = icmp sge i64 %100, %103
  %105 = select i1 %101, i1 true, i1 %104
  %106 = zext i1 %105 to i64
  %107 = getelementptr inbounds ptr, ptr %59, i64 %100
  %108 = load ptr, ptr %107, align 8
  %109 = getelementptr inbounds %struct.Operand, ptr %45, i64 %100
  %110 = getelementptr inbounds i8, ptr %108, i64 32
  %111 = load i64, ptr %110, align 8
  %112 = getelementptr inbounds i8, ptr %108, i64 40
  %113 = load ptr, ptr %112, align 8
  %114 = getelementptr inbounds i8, ptr %108, i64 16
  %115 = load i32, ptr %114, align 4
  %116 = icmp eq i32 %115, 12
  br i1 %116, label %117, label %152

117:
  %118 = icmp slt i64 %111, %106
  br i1 %118, label %152, label %119

119:
  %120 = sub nsw i64 %111, %106
  %121 = icmp sgt i64 %120, 24
  br i1 %121, label %152, label %122

122:
  %123 = getelementptr inbounds i8, ptr %108, i64 24
  %124 = load ptr, ptr %123, align 8
  store ptr %124, ptr %109, align 8
  store i64 %120, ptr %10, align 8
  %125 = icmp slt i64 %111, 1
  br i1 %125, label %152, label %126

126:
  %127 = phi i64 [ %129, %147 ], [ %111, %122 ]
  %128 = phi i64 [ %150, %147 ], [ 1, %122 ]
  %129 = add nsw i64 %127, -1
  %130 = load i64, ptr %10, align 8
  %131 = icmp sgt i64 %127, %130
  br i1 %131, label %147, label %132

132:
  %133 = getelementptr inbounds i64, ptr %113, i64 %129
  %134 = load i64, ptr %133, align 8
  %135 = icmp eq i64 %134, 1
  %136 = select i1 %135, i64 0, i64 %128
  %137 = getelementptr inbounds %struct.Operand, ptr %45, i64 %100, i32 1, i64 %129
  store i64 %136, ptr %137, align 8
  %138 = load i64, ptr %133, align 8
  %139 = icmp eq i64 %138, 1
  br i1 %139, label %147, label %140

140:
  %141 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 1, i64 %129
  %142 = load i64, ptr %141, align 8
  %143 = icmp eq i64 %142, 1
  %144 = icmp eq i64 %142, %138
  %145 = select i1 %143, i1 true, i1 %144
  br i1 %145, label %146, label %152

146:
  store i64 %138, ptr %141, align 8
  br label %147

147:
  %148 = getelementptr inbounds i64, ptr %113, i64 %129
  %149 = load i64, ptr %148, align 8
  %150 = mul nsw i64 %149, %128
  %151 = icmp slt i64 %127, 2
  br i1 %151, label %152, label %126

152:
  %153 = phi i1 [ false, %96 ], [ false, %117 ], [ false, %119 ], [ true, %122 ], [ false, %140 ], [ true, %147 ]
  %154 = phi ptr [ @.str.6, %96 ], [ @.str.7, %117 ], [ @.str.7, %119 ], [ null, %122 ], [ @.str.8, %140 ], [ null, %147 ]
  br i1 %153, label %160, label %155

155:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %6)
  store i64 32, ptr %6, align 8
  store ptr null, ptr %80, align 8
  store ptr %154, ptr %81, align 8
  store i32 3, ptr %82, align 8
  %156 = load ptr, ptr %83, align 8
  %157 = getelementptr inbounds i8, ptr %156, i64 48
  %158 = load ptr, ptr %157, align 8
  %159 = call ptr %158(ptr noundef nonnull %6)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %6)
  br label %172

160:
  %161 = icmp slt i64 %99, 0
  %162 = load i64, ptr %10, align 8
  %163 = icmp eq i64 %162, %99
  %164 = select i1 %161, i1 true, i1 %163
  br i1 %164, label %170, label %165

165:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %5)
  store i64 32, ptr %5, align 8
  store ptr null, ptr %84, align 8
  store ptr @.str.3, ptr %85, align 8
  store i32 3, ptr %86, align 8
  %166 = load ptr, ptr %83, align 8
  %167 = getelementptr inbounds i8, ptr %166, i64 48
  %168 = load ptr, ptr %167, align 8
  %169 = call ptr %168(ptr noundef nonnull %5)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %5)
  br label %172

170:
  %171 = load i64, ptr %10, align 8
  br label %172

172:
  %173 = phi i1 [ true, %170 ], [ false, %165 ], [ false, %155 ]
  %174 = phi i64 [ %171, %170 ], [ %99, %165 ], [ %99, %155 ]
  %175 = phi ptr [ %98, %170 ], [ %169, %165 ], [ %159, %155 ]
  br i1 %173, label %92, label %176

176:
  %177 = phi i1 [ %78, %77 ], [ %97, %172 ], [ %94, %92 ]
  %178 = phi ptr [ undef, %77 ], [ %175, %92 ], [ %175, %172 ]
  br i1 %177, label %478, label %179

179:
  %180 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 4), align 8
  %181 = icmp eq i64 %180, 0
  br i1 %181, label %192, label %182

182:
  %183 = add nsw i64 %25, -1
  %184 = getelementptr inbounds ptr, ptr %59, i64 %183
  %185 = load ptr, ptr %184, align 8
  %186 = getelementptr inbounds i8, ptr %185, i64 40
  %187 = load ptr, ptr %186, align 8
  %188 = load i64, ptr %10, align 8
  %189 = getelementptr inbounds i64, ptr %187, i64 %188
  %190 = load i64, ptr %189, align 8
  %191 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 12
  store i64 %190, ptr %191, align 8
  br label %192

192:
  %193 = load ptr, ptr %59, align 8
  %194 = getelementptr inbounds i8, ptr %193, i64 40
  %195 = load ptr, ptr %194, align 8
  %196 = load i64, ptr %10, align 8
  %197 = getelementptr inbounds i64, ptr %195, i64 %196
  %198 = load i64, ptr %197, align 8
  %199 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 2), align 8
  %200 = icmp eq i64 %198, %199
  br i1 %200, label %210, label %201

201:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %4)
  store i64 32, ptr %4, align 8
  %202 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 1
  store ptr null, ptr %202, align 8
  %203 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 2
  store ptr @.str.4, ptr %203, align 8
  %204 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 3
  store i32 3, ptr %204, align 8
  %205 = getelementptr inbounds i8, ptr %0, i64 16
  %206 = load ptr, ptr %205, align 8
  %207 = getelementptr inbounds i8, ptr %206, i64 48
  %208 = load ptr, ptr %207, align 8
  %209 = call ptr %208(ptr noundef nonnull %4)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %4)
  br label %478

210:
  %211 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 4
  store ptr %45, ptr %211, align 8
  %212 = getelementptr inbounds %struct.Operand, ptr %45, i64 1
  %213 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 5
  store ptr %212, ptr %213, align 8
  %214 = getelementptr inbounds %struct.Operand, ptr %45, i64 2
  %215 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 6
  store ptr %214, ptr %215, align 8
  %216 = load i64, ptr %57, align 8
  %217 = getelementptr inbounds %struct.Operand, ptr %214, i64 %216
  %218 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 7
  store ptr %217, ptr %218, align 8
  %219 = getelementptr inbounds %struct.Operand, ptr %217, i64 1
  %220 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 8
  store ptr %219, ptr %220, align 8
  %221 = getelementptr inbounds %struct.Operand, ptr %219, i64 1
  %222 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 9
  store ptr %221, ptr %222, align 8
  %223 = getelementptr inbounds %struct.Operand, ptr %45, i64 %25
  %224 = getelementptr inbounds %struct.Operand, ptr %223, i64 -1
  %225 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 10
  store ptr %224, ptr %225, align 8
  %226 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 2
  store i64 1, ptr %226, align 8
  %227 = icmp sgt i64 %196, 0
  br i1 %227, label %234, label %228

228:
  %229 = load i64, ptr @operation, align 8
  %230 = icmp sgt i64 %229, 0
  br i1 %230, label %231, label %243

231:
  %232 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 16
  %233 = load i64, ptr %232, align 8
  br label %251

234:
  %235 = phi i64 [ %239, %234 ], [ 1, %210 ]
  %236 = phi i64 [ %240, %234 ], [ 0, %210 ]
  %237 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 1, i64 %236
  %238 = load i64, ptr %237, align 8
  %239 = mul nsw i64 %238, %235
  store i64 %239, ptr %226, align 8
  %240 = add nuw nsw i64 %236, 1
  %241 = icmp eq i64 %240, %196
  br i1 %241, label %228, label %234

242:
  store i64 %258, ptr %232, align 8
  br label %243

243:
  %244 = load i64, ptr %226, align 8
  %245 = icmp eq i64 %244, 0
  br i1 %245, label %478, label %246

246:
  %247 = icmp sgt i64 %66, 0
  br i1 %247, label %248, label %303

248:
  %249 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 12
  %250 = load i64, ptr %249, align 8
  br label %266

251:
  %252 = phi i64 [ %233, %231 ], [ %258, %251 ]
  %253 = phi i64 [ %233, %231 ], [ %259, %251 ]
  %254 = phi i64 [ 0, %231 ], [ %260, %251 ]
  %255 = getelementptr inbounds %struct.Operation, ptr @operation, i64 0, i32 1, i64 %254, i32 4
  %256 = load i64, ptr %255, align 8
  %257 = icmp sgt i64 %256, %253
  %258 = select i1 %257, i64 %256, i64 %252
  %259 = call i64 @llvm.smax.i64(i64 %256, i64 %253)
  %260 = add nuw nsw i64 %254, 1
  %261 = icmp eq i64 %260, %229
  br i1 %261, label %242, label %251

262:
  %263 = add nuw nsw i64 %268, 1
  %264 = icmp slt i64 %263, %66
  %265 = icmp eq i64 %263, %66
  br i1 %265, label %303, label %266

266:
  %267 = phi i1 [ true, %248 ], [ %264, %262 ]
  %268 = phi i64 [ 0, %248 ], [ %263, %262 ]
  %269 = getelementptr inbounds ptr, ptr %61, i64 %268
  %270 = load ptr, ptr %269, align 8
  %271 = icmp slt i64 %268, %62
  %272 = select i1 %271, i64 1, i64 %250
  %273 = mul nsw i64 %272, %244
  %274 = getelementptr inbounds i8, ptr %270, i64 32
  %275 = load i64, ptr %274, align 8
  %276 = getelementptr inbounds i8, ptr %270, i64 40
  %277 = load ptr, ptr %276, align 8
  %278 = icmp sgt i64 %275, 0
  br i1 %278, label %279, label %287

279:
  %280 = phi i64 [ %285, %279 ], [ 0, %266 ]
  %281 = phi i64 [ %284, %279 ], [ 1, %266 ]
  %282 = getelementptr inbounds i64, ptr %277, i64 %280
  %283 = load i64, ptr %282, align 8
  %284 = mul nsw i64 %283, %281
  %285 = add nuw nsw i64 %280, 1
  %286 = icmp eq i64 %285, %275
  br i1 %286, label %287, label %279

287:
  %288 = phi i64 [ 1, %266 ], [ %284, %279 ]
  %289 = getelementptr inbounds i8, ptr %270, i64 16
  %290 = load i32, ptr %289, align 4
  %291 = icmp ne i32 %290, 12
  %292 = icmp ne i64 %288, %273
  %293 = select i1 %291, i1 true, i1 %292
  br i1 %293, label %294, label %262

294:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %3)
  store i64 32, ptr %3, align 8
  %295 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 1
  store ptr null, ptr %295, align 8
  %296 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 2
  store ptr @.str.5, ptr %296, align 8
  %297 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 3
  store i32 3, ptr %297, align 8
  %298 = getelementptr inbounds i8, ptr %0, i64 16
  %299 = load ptr, ptr %298, align 8
  %300 = getelementptr inbounds i8, ptr %299, i64 48
  %301 = load ptr, ptr %300, align 8
  %302 = call ptr %301(ptr noundef nonnull %3)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %3)
  br label %303

303:
  %304 = phi i1 [ %267, %294 ], [ %247, %246 ], [ %264, %262 ]
  %305 = phi ptr [ %302, %294 ], [ %178, %246 ], [ %178, %262 ]
  br i1 %304, label %478, label %306

306:
  %307 = shl i64 %66, 3
  %308 = call noalias ptr @malloc(i64 noundef %307)
  %309 = load i64, ptr %226, align 8
  %310 = shl i64 %309, 4
  %311 = call noalias ptr @malloc(i64 noundef %310)
  %312 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 13
  store ptr %311, ptr %312, align 8
  %313 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 11
  store ptr %308, ptr %313, align 8
  %314 = icmp eq ptr %308, null
  %315 = icmp eq ptr %311, null
  %316 = or i1 %314, %315
  br i1 %316, label %462, label %317

317:
  br i1 %247, label %453, label %318

318:
  %319 = load i64, ptr @operation, align 8
  %320 = icmp sgt i64 %319, 0
  br i1 %320, label %321, label %397

321:
  %322 = phi i64 [ %394, %391 ], [ 0, %318 ]
  %323 = phi i64 [ %327, %391 ], [ 0, %318 ]
  %324 = load i64, ptr %226, align 8
  %325 = icmp sgt i64 %324, 0
  br i1 %325, label %330, label %326

326:
  %327 = phi i64 [ %323, %321 ], [ %384, %383 ]
  %328 = sub nsw i64 %327, %323
  %329 = icmp sgt i64 %328, 8
  br i1 %329, label %388, label %391

330:
  %331 = phi i64 [ %385, %383 ], [ 0, %321 ]
  %332 = phi i64 [ %384, %383 ], [ %323, %321 ]
  %333 = load ptr, ptr %220, align 8
  %334 = load ptr, ptr %333, align 8
  %335 = load i64, ptr %10, align 8
  %336 = icmp sgt i64 %335, 0
  br i1 %336, label %337, label %351

337:
  %338 = phi i64 [ %341, %337 ], [ %335, %330 ]
  %339 = phi ptr [ %348, %337 ], [ %334, %330 ]
  %340 = phi i64 [ %349, %337 ], [ %331, %330 ]
  %341 = add nsw i64 %338, -1
  %342 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 1, i64 %341
  %343 = load i64, ptr %342, align 8
  %344 = srem i64 %340, %343
  %345 = getelementptr inbounds %struct.Operand, ptr %333, i64 0, i32 1, i64 %341
  %346 = load i64, ptr %345, align 8
  %347 = mul nsw i64 %346, %344
  %348 = getelementptr inbounds double, ptr %339, i64 %347
  %349 = sdiv i64 %340, %343
  %350 = icmp sgt i64 %338, 1
  br i1 %350, label %337, label %351

351:
  %352 = phi ptr [ %334, %330 ], [ %348, %337 ]
  %353 = load double, ptr %352, align 8
  %354 = fptosi double %353 to i32
  %355 = zext i32 %354 to i64
  %356 = icmp eq i64 %322, %355
  br i1 %356, label %357, label %383

357:
  %358 = load ptr, ptr %218, align 8
  %359 = load ptr, ptr %358, align 8
  br i1 %336, label %360, label %374

360:
  %361 = phi i64 [ %364, %360 ], [ %335, %357 ]
  %362 = phi ptr [ %371, %360 ], [ %359, %357 ]
  %363 = phi i64 [ %372, %360 ], [ %331, %357 ]
  %364 = add nsw i64 %361, -1
  %365 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 1, i64 %364
  %366 = load i64, ptr %365, align 8
  %367 = srem i64 %363, %366
  %368 = getelementptr inbounds %struct.Operand, ptr %358, i64 0, i32 1, i64 %364
  %369 = load i64, ptr %368, align 8
  %370 = mul nsw i64 %369, %367
  %371 = getelementptr inbounds double, ptr %362, i64 %370
  %372 = sdiv i64 %363, %366
  %373 = icmp sgt i64 %361, 1
  br i1 %373, label %360, label %374

374:
  %375 = phi ptr [ %359, %357 ], [ %371, %360 ]
  %376 = load double, ptr %375, align 8
  %377 = load ptr, ptr %312, align 8
  %378 = add nsw i64 %332, 1
  %379 = getelementptr inbounds %struct.Turn, ptr %377, i64 %332
  %380 = fcmp ord double %376, 0.000000e+00
  %381 = select i1 %380, double %376, double 0.000000e+00
  store double %381, ptr %379, align 8
  %382 = getelementptr inbounds i8, ptr %379, i64 8
  store i64 %331, ptr %382, align 8
  br label %383

383:
  %384 = phi i64 [ %378, %374 ], [ %332, %351 ]
  %385 = add nuw nsw i64 %331, 1
  %386 = load i64, ptr %226, align 8
  %387 = icmp slt i64 %385, %386
  br i1 %387, label %330, label %326

388:
  %389 = load ptr, ptr %312, align 8
  %390 = getelementptr inbounds %struct.Turn, ptr %389, i64 %323
  call void @qsort(ptr noundef %390, i64 noundef %328, i64 noundef 16, ptr noundef nonnull @longer_first)
  br label %391

391:
  %392 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 14, i64 %322
  store i64 %323, ptr %392, align 8
  %393 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 15, i64 %322
  store i64 %327, ptr %393, align 8
  %394 = add nuw nsw i64 %322, 1
  %395 = load i64, ptr @operation, align 8
  %396 = icmp sgt i64 %395, %394
  br i1 %396, label %321, label %397

397:
  %398 = load i64, ptr %226, align 8
  %399 = add nsw i64 %398, 7
  %400 = sdiv i64 %399, 8
  %401 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 5), align 8
  %402 = call i64 @llvm.smin.i64(i64 %400, i64 %401)
  %403 = icmp sgt i64 %402, 1
  br i1 %403, label %404, label %407

404:
  %405 = shl i64 %402, 3
  %406 = call noalias ptr @malloc(i64 noundef %405)
  br label %407

407:
  %408 = phi ptr [ %406, %404 ], [ null, %397 ]
  %409 = icmp ne ptr %408, null
  %410 = and i1 %403, %409
  br i1 %410, label %411, label %431

411:
  %412 = phi i64 [ %429, %428 ], [ 1, %407 ]
  %413 = getelementptr inbounds i64, ptr %408, i64 %412
  %414 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 6), align 8
  %415 = icmp eq ptr %414, null
  br i1 %415, label %419, label %416

416:
  %417 = call i32 %414(ptr noundef nonnull %413, ptr noundef null, ptr noundef nonnull @work, ptr noundef nonnull %10)
  %418 = icmp eq i32 %417, 0
  br label %426

419:
  %420 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 8), align 8
  %421 = icmp eq ptr %420, null
  br i1 %421, label %431, label %422

422:
  %423 = call ptr %420(ptr noundef null, i64 noundef 0, ptr noundef nonnull @work_on_windows, ptr noundef nonnull %10, i32 noundef 0, ptr noundef null)
  %424 = ptrtoint ptr %423 to i64
  store i64 %424, ptr %413, align 8
  %425 = icmp ne ptr %423, null
  br label %426

426:
  %427 = phi i1 [ %418, %416 ], [ %425, %422 ]
  br i1 %427, label %428, label %431

428:
  %429 = add nuw nsw i64 %412, 1
  %430 = icmp eq i64 %429, %402
  br i1 %430, label %431, label %411

431:
  %432 = phi i64 [ 1, %407 ], [ %412, %419 ], [ %412, %426 ], [ %429, %428 ]
  %433 = call ptr @work(ptr noundef nonnull %10)
  %434 = icmp ugt i64 %432, 1
  br i1 %434, label %435, label %452

435:
  %436 = phi i64 [ %450, %449 ], [ 1, %431 ]
  %437 = getelementptr inbounds i64, ptr %408, i64 %436
  %438 = load i64, ptr %437, align 8
  %439 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 7), align 8
  %440 = icmp eq ptr %439, null
  br i1 %440, label %443, label %441

441:
  %442 = call i32 %439(i64 noundef %438, ptr noundef null)
  br label %449

443:
  %444 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 9), align 8
  %445 = inttoptr i64 %438 to ptr
  %446 = call i32 %444(ptr noundef %445, i32 noundef -1)
  %447 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 10), align 8
  %448 = call i32 %447(ptr noundef %445)
  br label %449

449:
  %450 = add nuw nsw i64 %436, 1
  %451 = icmp eq i64 %450, %432
  br i1 %451, label %452, label %435

452:
  call void @free(ptr noundef %408)
  br label %464

453:
  %454 = phi i64 [ %460, %453 ], [ 0, %317 ]
  %455 = getelementptr inbounds ptr, ptr %61, i64 %454
  %456 = load ptr, ptr %455, align 8
  %457 = getelementptr inbounds i8, ptr %456, i64 24
  %458 = load ptr, ptr %457, align 8
  %459 = getelementptr inbounds ptr, ptr %308, i64 %454
  store ptr %458, ptr %459, align 8
  %460 = add nuw nsw i64 %454, 1
  %461 = icmp eq i64 %460, %66
  br i1 %461, label %318, label %453

462:
  %463 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 17
  store i32 1, ptr %463, align 8
  br label %464

464:
  %465 = load ptr, ptr %312, align 8
  call void @free(ptr noundef %465)
  call void @free(ptr noundef %308)
  %466 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 17
  %467 = load i32, ptr %466, align 8
  %468 = icmp eq i32 %467, 0
  br i1 %468, label %478, label %469

469:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %2)
  store i64 32, ptr %2, align 8
  %470 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 1
  store ptr null, ptr %470, align 8
  %471 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 2
  store ptr @.str.1, ptr %471, align 8
  %472 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 3
  store i32 8, ptr %472, align 8
  %473 = getelementptr inbounds i8, ptr %0, i64 16
  %474 = load ptr, ptr %473, align 8
  %475 = getelementptr inbounds i8, ptr %474, i64 48
  %476 = load ptr, ptr %475, align 8
  %477 = call ptr %476(ptr noundef nonnull %2)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %2)
  br label %478

478:
  %479 = phi ptr [ %76, %68 ], [ %209, %201 ], [ %178, %176 ], [ null, %243 ], [ %305, %303 ], [ %477, %469 ], [ null, %464 ]
  call void @free(ptr noundef %45)
  call void @llvm.lifetime.end.p0(i64 824, ptr nonnull %10)
  br label %480

480:
  %481 = phi ptr [ null, %18 ], [ %42, %34 ], [ %479, %478 ], [ %55, %47 ]
  ret ptr %481
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

define internal i32 @work_on_windows(ptr noundef %0) {
  %2 = tail call ptr @work(ptr noundef %0)
  ret i32 0
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

