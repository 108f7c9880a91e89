; Made from driver.c by 'make driver'; sha256 8f944c4b3ba1f58d547920832acb1e2dee7cd7a8c8de72ac451c694e7583f9e5

%struct.Operation = type { i64, [32 x %struct.Program], [32 x i64], ptr, ptr, i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr }
%struct.Program = type { ptr, ptr, ptr, ptr, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, double, double, [7 x double] }
%struct.Operand = type { ptr, [24 x i64] }
%struct.Job = type { ptr, i64, [24 x i64], i64, i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, i64, ptr, ptr, [32 x i64], [32 x i64], i32, i32 }
%struct.Rows = type { ptr, i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr }
%struct.Turn = type { double, i64, i64 }
%struct.anon = type { i64, ptr, ptr, i32 }
%struct.Columns = type { ptr, [8 x i64], [8 x i64], [8 x double], [8 x i64], [8 x i64] }
%struct.Course = type { ptr, i64, i64, double }

@operation = dso_local global %struct.Operation zeroinitializer, align 8
@.str = private unnamed_addr constant [28 x i8] c"jaximpact: too few operands\00", align 1
@.str.1 = private unnamed_addr constant [25 x i8] c"jaximpact: out of memory\00", align 1
@.str.2 = private unnamed_addr constant [37 x i8] c"jaximpact: a wrong number of results\00", align 1
@.str.3 = private unnamed_addr constant [41 x i8] c"jaximpact: operands differ in their axes\00", align 1
@.str.4 = private unnamed_addr constant [36 x i8] c"jaximpact: a wrong number of inputs\00", align 1
@.str.5 = private unnamed_addr constant [61 x i8] c"jaximpact: a result is not float64 of the shape of the lanes\00", align 1
@.str.6 = private unnamed_addr constant [23 x i8] c"jaximpact: interrupted\00", align 1
@.str.7 = private unnamed_addr constant [63 x i8] c"jaximpact computes in float64, but an operand has another type\00", align 1
@.str.8 = private unnamed_addr constant [70 x i8] c"jaximpact: impacts take arrays of at most 24 axes, with those of vmap\00", align 1
@.str.9 = private unnamed_addr constant [37 x i8] c"jaximpact: operands do not broadcast\00", align 1

define dso_local i64 @compute_rows(ptr nocapture noundef readonly %0) local_unnamed_addr {
  %2 = alloca %struct.Operand, align 8
  %3 = alloca %struct.Operand, align 8
  %4 = alloca %struct.Operand, align 8
  %5 = alloca %struct.Operand, align 8
  %6 = alloca %struct.Operand, align 8
  %7 = alloca %struct.Operand, align 8
  %8 = alloca %struct.Job, align 8
  %9 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 1
  %10 = load i64, ptr %9, align 8
  %11 = icmp eq i64 %10, 0
  br i1 %11, label %118, label %12

12:
  %13 = load ptr, ptr %0, align 8
  %14 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 3
  %15 = load i64, ptr %14, align 8
  %16 = getelementptr inbounds %struct.Operation, ptr %13, i64 0, i32 1, i64 0, i32 7
  %17 = load i64, ptr %16, align 8
  %18 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 14
  %19 = load ptr, ptr %18, align 8
  %20 = icmp eq ptr %19, null
  br i1 %20, label %21, label %24

21:
  %22 = getelementptr inbounds %struct.Operation, ptr %13, i64 0, i32 1, i64 0, i32 14
  %23 = load i64, ptr %22, align 8
  br label %24

24:
  %25 = phi i64 [ %23, %21 ], [ 0, %12 ]
  call void @llvm.lifetime.start.p0(i64 200, ptr nonnull %2)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(200) %2, i8 0, i64 200, i1 false)
  %26 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 5
  %27 = load ptr, ptr %26, align 8
  store ptr %27, ptr %2, align 8
  call void @llvm.lifetime.start.p0(i64 200, ptr nonnull %3)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(200) %3, i8 0, i64 200, i1 false)
  %28 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 6
  %29 = load ptr, ptr %28, align 8
  store ptr %29, ptr %3, align 8
  call void @llvm.lifetime.start.p0(i64 200, ptr nonnull %4)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(200) %4, i8 0, i64 200, i1 false)
  %30 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 8
  %31 = load ptr, ptr %30, align 8
  store ptr %31, ptr %4, align 8
  %32 = getelementptr inbounds %struct.Operand, ptr %4, i64 0, i32 1
  store i64 1, ptr %32, align 8
  call void @llvm.lifetime.start.p0(i64 200, ptr nonnull %5)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(200) %5, i8 0, i64 200, i1 false)
  %33 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 9
  %34 = load ptr, ptr %33, align 8
  store ptr %34, ptr %5, align 8
  %35 = getelementptr inbounds %struct.Operand, ptr %5, i64 0, i32 1
  store i64 1, ptr %35, align 8
  call void @llvm.lifetime.start.p0(i64 200, ptr nonnull %6)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(200) %6, i8 0, i64 200, i1 false)
  %36 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 10
  %37 = load ptr, ptr %36, align 8
  store ptr %37, ptr %6, align 8
  call void @llvm.lifetime.start.p0(i64 200, ptr nonnull %7)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(200) %7, i8 0, i64 200, i1 false)
  %38 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 11
  %39 = load ptr, ptr %38, align 8
  store ptr %39, ptr %7, align 8
  %40 = getelementptr inbounds %struct.Operand, ptr %7, i64 0, i32 1
  %41 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 4
  %42 = load i64, ptr %41, align 8
  store i64 %42, ptr %40, align 8
  %43 = add nsw i64 %15, 1
  %44 = tail call noalias ptr @calloc(i64 noundef %43, i64 noundef 200)
  %45 = add nsw i64 %25, %17
  %46 = shl i64 %45, 3
  %47 = tail call noalias ptr @malloc(i64 noundef %46)
  call void @llvm.lifetime.start.p0(i64 856, ptr nonnull %8)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(856) %8, i8 0, i64 856, i1 false)
  store ptr %13, ptr %8, align 8
  %48 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1
  store i64 1, ptr %48, align 8
  %49 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 2
  store i64 %10, ptr %49, align 8
  %50 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 3
  store i64 %10, ptr %50, align 8
  %51 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 4
  %52 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 2
  %53 = load i64, ptr %52, align 8
  store i64 %53, ptr %51, align 8
  %54 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 7
  store i64 %15, ptr %54, align 8
  %55 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 8
  store ptr %2, ptr %55, align 8
  %56 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 9
  store ptr %3, ptr %56, align 8
  %57 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 10
  store ptr %44, ptr %57, align 8
  %58 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 11
  %59 = icmp eq ptr %31, null
  %60 = select i1 %59, ptr null, ptr %4
  store ptr %60, ptr %58, align 8
  %61 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 12
  %62 = icmp eq ptr %34, null
  %63 = select i1 %62, ptr null, ptr %5
  store ptr %63, ptr %61, align 8
  %64 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 13
  store ptr %6, ptr %64, align 8
  %65 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 14
  store ptr %7, ptr %65, align 8
  %66 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 15
  store ptr %47, ptr %66, align 8
  %67 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 16
  store i64 %42, ptr %67, align 8
  %68 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 17
  store ptr %19, ptr %68, align 8
  %69 = icmp ne ptr %44, null
  %70 = icmp ne ptr %47, null
  %71 = and i1 %69, %70
  br i1 %71, label %72, label %112

72:
  %73 = icmp sgt i64 %15, 0
  br i1 %73, label %74, label %77

74:
  %75 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 7
  %76 = load ptr, ptr %75, align 8
  br label %82

77:
  %78 = icmp sgt i64 %17, 0
  br i1 %78, label %79, label %90

79:
  %80 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 12
  %81 = load ptr, ptr %80, align 8
  br label %96

82:
  %83 = phi i64 [ 0, %74 ], [ %88, %82 ]
  %84 = mul nsw i64 %83, %10
  %85 = getelementptr inbounds double, ptr %76, i64 %84
  %86 = getelementptr inbounds %struct.Operand, ptr %44, i64 %83
  store ptr %85, ptr %86, align 8
  %87 = getelementptr inbounds %struct.Operand, ptr %44, i64 %83, i32 1
  store i64 1, ptr %87, align 8
  %88 = add nuw nsw i64 %83, 1
  %89 = icmp eq i64 %88, %15
  br i1 %89, label %77, label %82

90:
  %91 = icmp sgt i64 %25, 0
  br i1 %91, label %92, label %103

92:
  %93 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 13
  %94 = load ptr, ptr %93, align 8
  %95 = mul i64 %42, %10
  br label %104

96:
  %97 = phi i64 [ 0, %79 ], [ %101, %96 ]
  %98 = mul nsw i64 %97, %10
  %99 = getelementptr inbounds double, ptr %81, i64 %98
  %100 = getelementptr inbounds ptr, ptr %47, i64 %97
  store ptr %99, ptr %100, align 8
  %101 = add nuw nsw i64 %97, 1
  %102 = icmp eq i64 %101, %17
  br i1 %102, label %90, label %96

103:
  call fastcc void @compute(ptr noundef nonnull %8)
  br label %114

104:
  %105 = phi i64 [ 0, %92 ], [ %110, %104 ]
  %106 = mul i64 %95, %105
  %107 = getelementptr inbounds double, ptr %94, i64 %106
  %108 = add nsw i64 %105, %17
  %109 = getelementptr inbounds ptr, ptr %47, i64 %108
  store ptr %107, ptr %109, align 8
  %110 = add nuw nsw i64 %105, 1
  %111 = icmp eq i64 %110, %25
  br i1 %111, label %103, label %104

112:
  %113 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 21
  store i32 1, ptr %113, align 8
  br label %114

114:
  call void @free(ptr noundef %47)
  call void @free(ptr noundef %44)
  %115 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 21
  %116 = load i32, ptr %115, align 8
  %117 = sext i32 %116 to i64
  call void @llvm.lifetime.end.p0(i64 856, ptr nonnull %8)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %7)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %6)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %5)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %4)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %3)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %2)
  br label %118

118:
  %119 = phi i64 [ %117, %114 ], [ 0, %1 ]
  ret i64 %119
}

declare void @llvm.lifetime.start.p0(i64 immarg, ptr nocapture)

declare void @llvm.memset.p0.i64(ptr nocapture writeonly, i8, i64, i1 immarg)

declare noalias noundef ptr @calloc(i64 noundef, i64 noundef) local_unnamed_addr

declare noalias noundef ptr @malloc(i64 noundef) local_unnamed_addr

declare void @llvm.lifetime.end.p0(i64 immarg, ptr nocapture)

define internal fastcc void @compute(ptr noundef %0) unnamed_addr {
  %2 = load ptr, ptr %0, align 8
  %3 = getelementptr inbounds %struct.Operation, ptr %2, i64 0, i32 6
  %4 = load i64, ptr %3, align 8
  %5 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 3
  %6 = load i64, ptr %5, align 8
  %7 = sdiv i64 4, %6
  %8 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 5
  store i64 %4, ptr %8, align 8
  %9 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 6
  store i64 1, ptr %9, align 8
  %10 = icmp slt i64 %4, 2
  %11 = icmp slt i64 %7, 2
  %12 = select i1 %10, i1 true, i1 %11
  br i1 %12, label %19, label %13

13:
  %14 = add i64 %4, -1
  %15 = add i64 %7, %14
  %16 = sdiv i64 %15, %7
  store i64 %16, ptr %8, align 8
  %17 = add i64 %16, %14
  %18 = sdiv i64 %17, %16
  store i64 %18, ptr %9, align 8
  br label %19

19:
  %20 = load i64, ptr %9, align 8
  %21 = mul nsw i64 %20, %6
  %22 = mul i64 %21, 24
  %23 = tail call noalias ptr @malloc(i64 noundef %22)
  %24 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 18
  store ptr %23, ptr %24, align 8
  %25 = icmp eq ptr %23, null
  br i1 %25, label %26, label %28

26:
  %27 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 21
  store i32 1, ptr %27, align 8
  br label %243

28:
  %29 = load i64, ptr %2, align 8
  %30 = icmp sgt i64 %29, 0
  br i1 %30, label %31, label %147

31:
  %32 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 12
  %33 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 1
  %34 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 11
  br label %35

35:
  %36 = phi i64 [ 0, %31 ], [ %41, %140 ]
  %37 = phi i64 [ 0, %31 ], [ %143, %140 ]
  %38 = load i64, ptr %5, align 8
  %39 = icmp sgt i64 %38, 0
  br i1 %39, label %44, label %40

40:
  %41 = phi i64 [ %36, %35 ], [ %130, %129 ]
  %42 = load ptr, ptr %34, align 8
  %43 = icmp eq ptr %42, null
  br i1 %43, label %140, label %134

44:
  %45 = phi i64 [ %131, %129 ], [ 0, %35 ]
  %46 = phi i64 [ %130, %129 ], [ %36, %35 ]
  %47 = load ptr, ptr %32, align 8
  %48 = icmp eq ptr %47, null
  br i1 %48, label %79, label %49

49:
  %50 = load i64, ptr %33, align 8
  %51 = icmp eq i64 %50, 1
  %52 = load ptr, ptr %47, align 8
  br i1 %51, label %53, label %58

53:
  %54 = getelementptr inbounds %struct.Operand, ptr %47, i64 0, i32 1
  %55 = load i64, ptr %54, align 8
  %56 = mul nsw i64 %55, %45
  %57 = getelementptr inbounds double, ptr %52, i64 %56
  br label %74

58:
  %59 = icmp sgt i64 %50, 0
  br i1 %59, label %60, label %74

60:
  %61 = phi i64 [ %64, %60 ], [ %50, %58 ]
  %62 = phi ptr [ %71, %60 ], [ %52, %58 ]
  %63 = phi i64 [ %72, %60 ], [ %45, %58 ]
  %64 = add nsw i64 %61, -1
  %65 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %64
  %66 = load i64, ptr %65, align 8
  %67 = srem i64 %63, %66
  %68 = getelementptr inbounds %struct.Operand, ptr %47, i64 0, i32 1, i64 %64
  %69 = load i64, ptr %68, align 8
  %70 = mul nsw i64 %69, %67
  %71 = getelementptr inbounds double, ptr %62, i64 %70
  %72 = sdiv i64 %63, %66
  %73 = icmp sgt i64 %61, 1
  br i1 %73, label %60, label %74

74:
  %75 = phi ptr [ %57, %53 ], [ %52, %58 ], [ %71, %60 ]
  %76 = load double, ptr %75, align 8
  %77 = fptosi double %76 to i64
  %78 = icmp eq i64 %37, %77
  br i1 %78, label %79, label %129

79:
  %80 = load ptr, ptr %34, align 8
  %81 = icmp eq ptr %80, null
  br i1 %81, label %110, label %82

82:
  %83 = load i64, ptr %33, align 8
  %84 = icmp eq i64 %83, 1
  %85 = load ptr, ptr %80, align 8
  br i1 %84, label %86, label %91

86:
  %87 = getelementptr inbounds %struct.Operand, ptr %80, i64 0, i32 1
  %88 = load i64, ptr %87, align 8
  %89 = mul nsw i64 %88, %45
  %90 = getelementptr inbounds double, ptr %85, i64 %89
  br label %107

91:
  %92 = icmp sgt i64 %83, 0
  br i1 %92, label %93, label %107

93:
  %94 = phi i64 [ %97, %93 ], [ %83, %91 ]
  %95 = phi ptr [ %104, %93 ], [ %85, %91 ]
  %96 = phi i64 [ %105, %93 ], [ %45, %91 ]
  %97 = add nsw i64 %94, -1
  %98 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %97
  %99 = load i64, ptr %98, align 8
  %100 = srem i64 %96, %99
  %101 = getelementptr inbounds %struct.Operand, ptr %80, i64 0, i32 1, i64 %97
  %102 = load i64, ptr %101, align 8
  %103 = mul nsw i64 %102, %100
  %104 = getelementptr inbounds double, ptr %95, i64 %103
  %105 = sdiv i64 %96, %99
  %106 = icmp sgt i64 %94, 1
  br i1 %106, label %93, label %107

107:
  %108 = phi ptr [ %90, %86 ], [ %85, %91 ], [ %104, %93 ]
  %109 = load double, ptr %108, align 8
  br label %110

110:
  %111 = phi double [ %109, %107 ], [ 0.000000e+00, %79 ]
  %112 = fcmp ord double %111, 0.000000e+00
  %113 = select i1 %112, double %111, double 0.000000e+00
  %114 = load i64, ptr %9, align 8
  %115 = icmp sgt i64 %114, 0
  br i1 %115, label %116, label %129

116:
  %117 = phi i64 [ %126, %116 ], [ 0, %110 ]
  %118 = phi i64 [ %120, %116 ], [ %46, %110 ]
  %119 = load ptr, ptr %24, align 8
  %120 = add nsw i64 %118, 1
  %121 = getelementptr inbounds %struct.Turn, ptr %119, i64 %118
  %122 = load i64, ptr %8, align 8
  %123 = mul nsw i64 %122, %117
  store double %113, ptr %121, align 8
  %124 = getelementptr inbounds i8, ptr %121, i64 8
  store i64 %45, ptr %124, align 8
  %125 = getelementptr inbounds i8, ptr %121, i64 16
  store i64 %123, ptr %125, align 8
  %126 = add nuw nsw i64 %117, 1
  %127 = load i64, ptr %9, align 8
  %128 = icmp slt i64 %126, %127
  br i1 %128, label %116, label %129

129:
  %130 = phi i64 [ %46, %74 ], [ %46, %110 ], [ %120, %116 ]
  %131 = add nuw nsw i64 %45, 1
  %132 = load i64, ptr %5, align 8
  %133 = icmp slt i64 %131, %132
  br i1 %133, label %44, label %40

134:
  %135 = sub nsw i64 %41, %36
  %136 = icmp sgt i64 %135, 8
  br i1 %136, label %137, label %140

137:
  %138 = load ptr, ptr %24, align 8
  %139 = getelementptr inbounds %struct.Turn, ptr %138, i64 %36
  tail call void @qsort(ptr noundef %139, i64 noundef %135, i64 noundef 24, ptr noundef nonnull @longer_first)
  br label %140

140:
  %141 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 19, i64 %37
  store i64 %36, ptr %141, align 8
  %142 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 20, i64 %37
  store i64 %41, ptr %142, align 8
  %143 = add nuw nsw i64 %37, 1
  %144 = load ptr, ptr %0, align 8
  %145 = load i64, ptr %144, align 8
  %146 = icmp slt i64 %143, %145
  br i1 %146, label %35, label %147

147:
  %148 = load ptr, ptr %0, align 8
  %149 = load i64, ptr %148, align 8
  %150 = icmp slt i64 %149, 1
  br i1 %150, label %176, label %151

151:
  %152 = getelementptr inbounds %struct.Operation, ptr %148, i64 0, i32 3
  br label %153

153:
  %154 = phi i1 [ false, %151 ], [ %175, %172 ]
  %155 = phi i64 [ 0, %151 ], [ %173, %172 ]
  %156 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 19, i64 %155
  %157 = load i64, ptr %156, align 8
  %158 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 20, i64 %155
  %159 = load i64, ptr %158, align 8
  %160 = icmp eq i64 %157, %159
  br i1 %160, label %172, label %161

161:
  %162 = getelementptr inbounds %struct.Operation, ptr %148, i64 0, i32 2, i64 %155
  %163 = load atomic i64, ptr %162 acquire, align 8
  %164 = icmp eq i64 %163, 0
  br i1 %164, label %172, label %165

165:
  %166 = load ptr, ptr %152, align 8
  %167 = tail call i64 %166(i64 noundef %155)
  %168 = icmp eq i64 %167, 1
  br i1 %168, label %171, label %169

169:
  %170 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 22
  store i32 1, ptr %170, align 4
  br label %176

171:
  store atomic i64 0, ptr %162 release, align 8
  br label %172

172:
  %173 = add nuw nsw i64 %155, 1
  %174 = load i64, ptr %148, align 8
  %175 = icmp sge i64 %173, %174
  br i1 %175, label %176, label %153

176:
  %177 = phi i1 [ %154, %169 ], [ %150, %147 ], [ %175, %172 ]
  br i1 %177, label %178, label %241

178:
  %179 = add nsw i64 %21, 7
  %180 = sdiv i64 %179, 8
  %181 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 4
  %182 = load i64, ptr %181, align 8
  %183 = tail call i64 @llvm.smin.i64(i64 %180, i64 %182)
  %184 = icmp sgt i64 %183, 1
  br i1 %184, label %185, label %188

185:
  %186 = shl i64 %183, 3
  %187 = tail call noalias ptr @malloc(i64 noundef %186)
  br label %188

188:
  %189 = phi ptr [ %187, %185 ], [ null, %178 ]
  %190 = icmp ne ptr %189, null
  %191 = and i1 %184, %190
  br i1 %191, label %192, label %215

192:
  %193 = phi i64 [ %213, %212 ], [ 1, %188 ]
  %194 = getelementptr inbounds i64, ptr %189, i64 %193
  %195 = load ptr, ptr %0, align 8
  %196 = getelementptr inbounds %struct.Operation, ptr %195, i64 0, i32 9
  %197 = load ptr, ptr %196, align 8
  %198 = icmp eq ptr %197, null
  br i1 %198, label %202, label %199

199:
  %200 = tail call i32 %197(ptr noundef nonnull %194, ptr noundef null, ptr noundef nonnull @work, ptr noundef nonnull %0)
  %201 = icmp eq i32 %200, 0
  br label %210

202:
  %203 = getelementptr inbounds %struct.Operation, ptr %195, i64 0, i32 11
  %204 = load ptr, ptr %203, align 8
  %205 = icmp eq ptr %204, null
  br i1 %205, label %215, label %206

206:
  %207 = tail call ptr %204(ptr noundef null, i64 noundef 0, ptr noundef nonnull @work_on_windows, ptr noundef nonnull %0, i32 noundef 0, ptr noundef null)
  %208 = ptrtoint ptr %207 to i64
  store i64 %208, ptr %194, align 8
  %209 = icmp ne ptr %207, null
  br label %210

210:
  %211 = phi i1 [ %201, %199 ], [ %209, %206 ]
  br i1 %211, label %212, label %215

212:
  %213 = add nuw nsw i64 %193, 1
  %214 = icmp eq i64 %213, %183
  br i1 %214, label %215, label %192

215:
  %216 = phi i64 [ 1, %188 ], [ %193, %202 ], [ %193, %210 ], [ %213, %212 ]
  %217 = tail call ptr @work(ptr noundef nonnull %0)
  %218 = icmp ugt i64 %216, 1
  br i1 %218, label %219, label %240

219:
  %220 = phi i64 [ %238, %237 ], [ 1, %215 ]
  %221 = load ptr, ptr %0, align 8
  %222 = getelementptr inbounds i64, ptr %189, i64 %220
  %223 = load i64, ptr %222, align 8
  %224 = getelementptr inbounds %struct.Operation, ptr %221, i64 0, i32 10
  %225 = load ptr, ptr %224, align 8
  %226 = icmp eq ptr %225, null
  br i1 %226, label %229, label %227

227:
  %228 = tail call i32 %225(i64 noundef %223, ptr noundef null)
  br label %237

229:
  %230 = getelementptr inbounds %struct.Operation, ptr %221, i64 0, i32 12
  %231 = load ptr, ptr %230, align 8
  %232 = inttoptr i64 %223 to ptr
  %233 = tail call i32 %231(ptr noundef %232, i32 noundef -1)
  %234 = getelementptr inbounds %struct.Operation, ptr %221, i64 0, i32 13
  %235 = load ptr, ptr %234, align 8
  %236 = tail call i32 %235(ptr noundef %232)
  br label %237

237:
  %238 = add nuw nsw i64 %220, 1
  %239 = icmp eq i64 %238, %216
  br i1 %239, label %240, label %219

240:
  tail call void @free(ptr noundef %189)
  br label %241

241:
  %242 = load ptr, ptr %24, align 8
  tail call void @free(ptr noundef %242)
  br label %243

243:
  ret void
}

declare void @free(ptr allocptr nocapture noundef) local_unnamed_addr

define dso_local ptr @impacts(ptr nocapture noundef readonly %0) local_unnamed_addr {
  %2 = alloca %struct.anon, align 8
  %3 = alloca %struct.anon, align 8
  %4 = alloca %struct.anon, align 8
  %5 = alloca %struct.anon, align 8
  %6 = alloca %struct.anon, align 8
  %7 = alloca %struct.anon, align 8
  %8 = alloca %struct.anon, align 8
  %9 = alloca %struct.anon, align 8
  %10 = alloca %struct.anon, align 8
  %11 = alloca %struct.Job, align 8
  %12 = getelementptr inbounds i8, ptr %0, i64 8
  %13 = load ptr, ptr %12, align 8
  %14 = icmp eq ptr %13, null
  br i1 %14, label %24, label %15

15:
  %16 = getelementptr inbounds i8, ptr %13, i64 8
  %17 = load i32, ptr %16, align 4
  %18 = icmp eq i32 %17, 1
  br i1 %18, label %19, label %24

19:
  %20 = getelementptr inbounds i8, ptr %13, i64 24
  %21 = load ptr, ptr %20, align 8
  %22 = getelementptr inbounds i8, ptr %21, i64 24
  store i32 0, ptr %22, align 4
  %23 = getelementptr inbounds i8, ptr %21, i64 28
  store i32 1, ptr %23, align 4
  br label %343

24:
  %25 = getelementptr inbounds i8, ptr %0, i64 56
  %26 = load i64, ptr %25, align 8
  %27 = add nsw i64 %26, -4
  %28 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 6), align 8
  %29 = icmp sgt i64 %28, 0
  %30 = sext i1 %29 to i64
  %31 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 7), align 8
  %32 = sub i64 %27, %31
  %33 = add i64 %32, %30
  %34 = icmp slt i64 %33, 0
  br i1 %34, label %35, label %44

35:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %10)
  store i64 32, ptr %10, align 8
  %36 = getelementptr inbounds %struct.anon, ptr %10, i64 0, i32 1
  store ptr null, ptr %36, align 8
  %37 = getelementptr inbounds %struct.anon, ptr %10, i64 0, i32 2
  store ptr @.str, ptr %37, align 8
  %38 = getelementptr inbounds %struct.anon, ptr %10, i64 0, i32 3
  store i32 3, ptr %38, align 8
  %39 = getelementptr inbounds i8, ptr %0, i64 16
  %40 = load ptr, ptr %39, align 8
  %41 = getelementptr inbounds i8, ptr %40, i64 48
  %42 = load ptr, ptr %41, align 8
  %43 = call ptr %42(ptr noundef nonnull %10)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %10)
  br label %343

44:
  %45 = mul i64 %26, 200
  %46 = tail call noalias ptr @malloc(i64 noundef %45)
  %47 = icmp eq ptr %46, null
  br i1 %47, label %48, label %57

48:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %9)
  store i64 32, ptr %9, align 8
  %49 = getelementptr inbounds %struct.anon, ptr %9, i64 0, i32 1
  store ptr null, ptr %49, align 8
  %50 = getelementptr inbounds %struct.anon, ptr %9, i64 0, i32 2
  store ptr @.str.1, ptr %50, align 8
  %51 = getelementptr inbounds %struct.anon, ptr %9, i64 0, i32 3
  store i32 8, ptr %51, align 8
  %52 = getelementptr inbounds i8, ptr %0, i64 16
  %53 = load ptr, ptr %52, align 8
  %54 = getelementptr inbounds i8, ptr %53, i64 48
  %55 = load ptr, ptr %54, align 8
  %56 = call ptr %55(ptr noundef nonnull %9)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %9)
  br label %343

57:
  call void @llvm.lifetime.start.p0(i64 856, ptr nonnull %11)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(856) %11, i8 0, i64 856, i1 false)
  store ptr @operation, ptr %11, align 8
  %58 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 4
  %59 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 8), align 8
  store i64 %59, ptr %58, align 8
  %60 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 7
  store i64 %33, ptr %60, align 8
  %61 = getelementptr inbounds i8, ptr %0, i64 72
  %62 = load ptr, ptr %61, align 8
  %63 = getelementptr inbounds i8, ptr %0, i64 112
  %64 = load ptr, ptr %63, align 8
  %65 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 1, i64 0, i32 7), align 8
  %66 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 1, i64 0, i32 14), align 8
  %67 = getelementptr inbounds i8, ptr %0, i64 96
  %68 = load i64, ptr %67, align 8
  %69 = add nsw i64 %66, %65
  %70 = icmp eq i64 %68, %69
  br i1 %70, label %91, label %71

71:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %8)
  store i64 32, ptr %8, align 8
  %72 = getelementptr inbounds %struct.anon, ptr %8, i64 0, i32 1
  store ptr null, ptr %72, align 8
  %73 = getelementptr inbounds %struct.anon, ptr %8, i64 0, i32 2
  store ptr @.str.2, ptr %73, align 8
  %74 = getelementptr inbounds %struct.anon, ptr %8, i64 0, i32 3
  store i32 3, ptr %74, align 8
  %75 = getelementptr inbounds i8, ptr %0, i64 16
  %76 = load ptr, ptr %75, align 8
  %77 = getelementptr inbounds i8, ptr %76, i64 48
  %78 = load ptr, ptr %77, align 8
  %79 = call ptr %78(ptr noundef nonnull %8)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %8)
  br label %341

80:
  %81 = icmp sgt i64 %26, 0
  br i1 %81, label %82, label %180

82:
  %83 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 1
  %84 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 1
  %85 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 2
  %86 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 3
  %87 = getelementptr inbounds i8, ptr %0, i64 16
  %88 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 1
  %89 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 2
  %90 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 3
  br label %100

91:
  %92 = phi i64 [ %94, %91 ], [ 0, %57 ]
  %93 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 2, i64 %92
  store i64 1, ptr %93, align 8
  %94 = add nuw nsw i64 %92, 1
  %95 = icmp eq i64 %94, 24
  br i1 %95, label %80, label %91

96:
  %97 = add nuw nsw i64 %104, 1
  %98 = icmp slt i64 %97, %26
  %99 = icmp eq i64 %97, %26
  br i1 %99, label %180, label %100

100:
  %101 = phi i1 [ true, %82 ], [ %98, %96 ]
  %102 = phi ptr [ undef, %82 ], [ %179, %96 ]
  %103 = phi i64 [ -1, %82 ], [ %178, %96 ]
  %104 = phi i64 [ 0, %82 ], [ %97, %96 ]
  %105 = icmp ult i64 %104, 2
  %106 = load i64, ptr %60, align 8
  %107 = add nsw i64 %106, 4
  %108 = icmp sge i64 %104, %107
  %109 = select i1 %105, i1 true, i1 %108
  %110 = zext i1 %109 to i64
  %111 = getelementptr inbounds ptr, ptr %62, i64 %104
  %112 = load ptr, ptr %111, align 8
  %113 = getelementptr inbounds %struct.Operand, ptr %46, i64 %104
  %114 = getelementptr inbounds i8, ptr %112, i64 32
  %115 = load i64, ptr %114, align 8
  %116 = getelementptr inbounds i8, ptr %112, i64 40
  %117 = load ptr, ptr %116, align 8
  %118 = getelementptr inbounds i8, ptr %112, i64 16
  %119 = load i32, ptr %118, align 4
  %120 = icmp eq i32 %119, 12
  br i1 %120, label %121, label %156

121:
  %122 = icmp slt i64 %115, %110
  br i1 %122, label %156, label %123

123:
  %124 = sub nsw i64 %115, %110
  %125 = icmp sgt i64 %124, 24
  br i1 %125, label %156, label %126

126:
  %127 = getelementptr inbounds i8, ptr %112, i64 24
  %128 = load ptr, ptr %127, align 8
  store ptr %128, ptr %113, align 8
  store i64 %124, ptr %83, align 8
  %129 = icmp slt i64 %115, 1
  br i1 %129, label %156, label %130

130:
  %131 = phi i64 [ %133, %151 ], [ %115, %126 ]
  %132 = phi i64 [ %154, %151 ], [ 1, %126 ]
  %133 = add nsw i64 %131, -1
  %134 = load i64, ptr %83, align 8
  %135 = icmp sgt i64 %131, %134
  br i1 %135, label %151, label %136

136:
  %137 = getelementptr inbounds i64, ptr %117, i64 %133
  %138 = load i64, ptr %137, align 8
  %139 = icmp eq i64 %138, 1
  %140 = select i1 %139, i64 0, i64 %132
  %141 = getelementptr inbounds %struct.Operand, ptr %46, i64 %104, i32 1, i64 %133
  store i64 %140, ptr %141, align 8
  %142 = load i64, ptr %137, align 8
  %143 = icmp eq i64 %142, 1
  br i1 %143, label %151, label %144

144:
  %145 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 2, i64 %133
  %146 = load i64, ptr %145, align 8
  %147 = icmp eq i64 %146, 1
  %148 = icmp eq i64 %146, %142
  %149 = select i1 %147, i1 true, i1 %148
  br i1 %149, label %150, label %156

150:
  store i64 %142, ptr %145, align 8
  br label %151

151:
  %152 = getelementptr inbounds i64, ptr %117, i64 %133
  %153 = load i64, ptr %152, align 8
  %154 = mul nsw i64 %153, %132
  %155 = icmp slt i64 %131, 2
  br i1 %155, label %156, label %130

156:
  %157 = phi i1 [ false, %100 ], [ false, %121 ], [ false, %123 ], [ true, %126 ], [ false, %144 ], [ true, %151 ]
  %158 = phi ptr [ @.str.7, %100 ], [ @.str.8, %121 ], [ @.str.8, %123 ], [ null, %126 ], [ @.str.9, %144 ], [ null, %151 ]
  br i1 %157, label %164, label %159

159:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %7)
  store i64 32, ptr %7, align 8
  store ptr null, ptr %84, align 8
  store ptr %158, ptr %85, align 8
  store i32 3, ptr %86, align 8
  %160 = load ptr, ptr %87, align 8
  %161 = getelementptr inbounds i8, ptr %160, i64 48
  %162 = load ptr, ptr %161, align 8
  %163 = call ptr %162(ptr noundef nonnull %7)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %7)
  br label %176

164:
  %165 = icmp slt i64 %103, 0
  %166 = load i64, ptr %83, align 8
  %167 = icmp eq i64 %166, %103
  %168 = select i1 %165, i1 true, i1 %167
  br i1 %168, label %174, label %169

169:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %6)
  store i64 32, ptr %6, align 8
  store ptr null, ptr %88, align 8
  store ptr @.str.3, ptr %89, align 8
  store i32 3, ptr %90, align 8
  %170 = load ptr, ptr %87, align 8
  %171 = getelementptr inbounds i8, ptr %170, i64 48
  %172 = load ptr, ptr %171, align 8
  %173 = call ptr %172(ptr noundef nonnull %6)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %6)
  br label %176

174:
  %175 = load i64, ptr %83, align 8
  br label %176

176:
  %177 = phi i1 [ true, %174 ], [ false, %169 ], [ false, %159 ]
  %178 = phi i64 [ %175, %174 ], [ %103, %169 ], [ %103, %159 ]
  %179 = phi ptr [ %102, %174 ], [ %173, %169 ], [ %163, %159 ]
  br i1 %177, label %96, label %180

180:
  %181 = phi i1 [ %81, %80 ], [ %101, %176 ], [ %98, %96 ]
  %182 = phi ptr [ undef, %80 ], [ %179, %96 ], [ %179, %176 ]
  br i1 %181, label %341, label %183

183:
  %184 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 7), align 8
  %185 = icmp eq i64 %184, 0
  br i1 %185, label %197, label %186

186:
  %187 = add nsw i64 %26, -1
  %188 = getelementptr inbounds ptr, ptr %62, i64 %187
  %189 = load ptr, ptr %188, align 8
  %190 = getelementptr inbounds i8, ptr %189, i64 40
  %191 = load ptr, ptr %190, align 8
  %192 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 1
  %193 = load i64, ptr %192, align 8
  %194 = getelementptr inbounds i64, ptr %191, i64 %193
  %195 = load i64, ptr %194, align 8
  %196 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 16
  store i64 %195, ptr %196, align 8
  br label %197

197:
  %198 = load ptr, ptr %62, align 8
  %199 = getelementptr inbounds i8, ptr %198, i64 40
  %200 = load ptr, ptr %199, align 8
  %201 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 1
  %202 = load i64, ptr %201, align 8
  %203 = getelementptr inbounds i64, ptr %200, i64 %202
  %204 = load i64, ptr %203, align 8
  %205 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 5), align 8
  %206 = icmp eq i64 %204, %205
  br i1 %206, label %216, label %207

207:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %5)
  store i64 32, ptr %5, align 8
  %208 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 1
  store ptr null, ptr %208, align 8
  %209 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 2
  store ptr @.str.4, ptr %209, align 8
  %210 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 3
  store i32 3, ptr %210, align 8
  %211 = getelementptr inbounds i8, ptr %0, i64 16
  %212 = load ptr, ptr %211, align 8
  %213 = getelementptr inbounds i8, ptr %212, i64 48
  %214 = load ptr, ptr %213, align 8
  %215 = call ptr %214(ptr noundef nonnull %5)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %5)
  br label %341

216:
  %217 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 8
  store ptr %46, ptr %217, align 8
  %218 = getelementptr inbounds %struct.Operand, ptr %46, i64 1
  %219 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 9
  store ptr %218, ptr %219, align 8
  %220 = getelementptr inbounds %struct.Operand, ptr %46, i64 2
  %221 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 10
  store ptr %220, ptr %221, align 8
  %222 = load i64, ptr %60, align 8
  %223 = getelementptr inbounds %struct.Operand, ptr %220, i64 %222
  %224 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 11
  store ptr %223, ptr %224, align 8
  %225 = getelementptr inbounds %struct.Operand, ptr %223, i64 1
  %226 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 12
  store ptr %225, ptr %226, align 8
  %227 = getelementptr inbounds %struct.Operand, ptr %225, i64 1
  %228 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 13
  store ptr %227, ptr %228, align 8
  %229 = getelementptr inbounds %struct.Operand, ptr %46, i64 %26
  %230 = getelementptr inbounds %struct.Operand, ptr %229, i64 -1
  %231 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 14
  store ptr %230, ptr %231, align 8
  %232 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 3
  store i64 1, ptr %232, align 8
  %233 = icmp sgt i64 %202, 0
  br i1 %233, label %242, label %234

234:
  %235 = load i64, ptr %232, align 8
  %236 = icmp eq i64 %235, 0
  br i1 %236, label %341, label %237

237:
  %238 = icmp sgt i64 %69, 0
  br i1 %238, label %239, label %291

239:
  %240 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 16
  %241 = load i64, ptr %240, align 8
  br label %254

242:
  %243 = phi i64 [ %247, %242 ], [ 1, %216 ]
  %244 = phi i64 [ %248, %242 ], [ 0, %216 ]
  %245 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 2, i64 %244
  %246 = load i64, ptr %245, align 8
  %247 = mul nsw i64 %246, %243
  store i64 %247, ptr %232, align 8
  %248 = add nuw nsw i64 %244, 1
  %249 = icmp eq i64 %248, %202
  br i1 %249, label %234, label %242

250:
  %251 = add nuw nsw i64 %256, 1
  %252 = icmp slt i64 %251, %69
  %253 = icmp eq i64 %251, %69
  br i1 %253, label %291, label %254

254:
  %255 = phi i1 [ true, %239 ], [ %252, %250 ]
  %256 = phi i64 [ 0, %239 ], [ %251, %250 ]
  %257 = getelementptr inbounds ptr, ptr %64, i64 %256
  %258 = load ptr, ptr %257, align 8
  %259 = icmp slt i64 %256, %65
  %260 = select i1 %259, i64 1, i64 %241
  %261 = mul nsw i64 %260, %235
  %262 = getelementptr inbounds i8, ptr %258, i64 32
  %263 = load i64, ptr %262, align 8
  %264 = getelementptr inbounds i8, ptr %258, i64 40
  %265 = load ptr, ptr %264, align 8
  %266 = icmp sgt i64 %263, 0
  br i1 %266, label %267, label %275

267:
  %268 = phi i64 [ %273, %267 ], [ 0, %254 ]
  %269 = phi i64 [ %272, %267 ], [ 1, %254 ]
  %270 = getelementptr inbounds i64, ptr %265, i64 %268
  %271 = load i64, ptr %270, align 8
  %272 = mul nsw i64 %271, %269
  %273 = add nuw nsw i64 %268, 1
  %274 = icmp eq i64 %273, %263
  br i1 %274, label %275, label %267

275:
  %276 = phi i64 [ 1, %254 ], [ %272, %267 ]
  %277 = getelementptr inbounds i8, ptr %258, i64 16
  %278 = load i32, ptr %277, align 4
  %279 = icmp ne i32 %278, 12
  %280 = icmp ne i64 %276, %261
  %281 = select i1 %279, i1 true, i1 %280
  br i1 %281, label %282, label %250

282:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %4)
  store i64 32, ptr %4, align 8
  %283 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 1
  store ptr null, ptr %283, align 8
  %284 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 2
  store ptr @.str.5, ptr %284, align 8
  %285 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 3
  store i32 3, ptr %285, align 8
  %286 = getelementptr inbounds i8, ptr %0, i64 16
  %287 = load ptr, ptr %286, align 8
  %288 = getelementptr inbounds i8, ptr %287, i64 48
  %289 = load ptr, ptr %288, align 8
  %290 = call ptr %289(ptr noundef nonnull %4)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %4)
  br label %291

291:
  %292 = phi i1 [ %255, %282 ], [ %238, %237 ], [ %252, %250 ]
  %293 = phi ptr [ %290, %282 ], [ %182, %237 ], [ %182, %250 ]
  br i1 %292, label %341, label %294

294:
  %295 = shl i64 %69, 3
  %296 = call noalias ptr @malloc(i64 noundef %295)
  %297 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 15
  store ptr %296, ptr %297, align 8
  %298 = icmp eq ptr %296, null
  br i1 %298, label %310, label %299

299:
  br i1 %238, label %301, label %300

300:
  call fastcc void @compute(ptr noundef nonnull %11)
  br label %312

301:
  %302 = phi i64 [ %308, %301 ], [ 0, %299 ]
  %303 = getelementptr inbounds ptr, ptr %64, i64 %302
  %304 = load ptr, ptr %303, align 8
  %305 = getelementptr inbounds i8, ptr %304, i64 24
  %306 = load ptr, ptr %305, align 8
  %307 = getelementptr inbounds ptr, ptr %296, i64 %302
  store ptr %306, ptr %307, align 8
  %308 = add nuw nsw i64 %302, 1
  %309 = icmp eq i64 %308, %69
  br i1 %309, label %300, label %301

310:
  %311 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 21
  store i32 1, ptr %311, align 8
  br label %312

312:
  call void @free(ptr noundef %296)
  %313 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 22
  %314 = load i32, ptr %313, align 4
  %315 = icmp eq i32 %314, 0
  br i1 %315, label %328, label %316

316:
  %317 = load ptr, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 4), align 8
  %318 = icmp eq ptr %317, null
  %319 = select i1 %318, ptr @.str.6, ptr %317
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %3)
  store i64 32, ptr %3, align 8
  %320 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 1
  store ptr null, ptr %320, align 8
  %321 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 2
  store ptr %319, ptr %321, align 8
  %322 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 3
  store i32 9, ptr %322, align 8
  %323 = getelementptr inbounds i8, ptr %0, i64 16
  %324 = load ptr, ptr %323, align 8
  %325 = getelementptr inbounds i8, ptr %324, i64 48
  %326 = load ptr, ptr %325, align 8
  %327 = call ptr %326(ptr noundef nonnull %3)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %3)
  br label %341

328:
  %329 = getelementptr inbounds %struct.Job, ptr %11, i64 0, i32 21
  %330 = load i32, ptr %329, align 8
  %331 = icmp eq i32 %330, 0
  br i1 %331, label %341, label %332

332:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %2)
  store i64 32, ptr %2, align 8
  %333 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 1
  store ptr null, ptr %333, align 8
  %334 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 2
  store ptr @.str.1, ptr %334, align 8
  %335 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 3
  store i32 8, ptr %335, align 8
  %336 = getelementptr inbounds i8, ptr %0, i64 16
  %337 = load ptr, ptr %336, align 8
  %338 = getelementptr inbounds i8, ptr %337, i64 48
  %339 = load ptr, ptr %338, align 8
  %340 = call ptr %339(ptr noundef nonnull %2)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %2)
  br label %341

341:
  %342 = phi ptr [ %79, %71 ], [ %215, %207 ], [ %182, %180 ], [ null, %234 ], [ %293, %291 ], [ %327, %316 ], [ %340, %332 ], [ null, %328 ]
  call void @free(ptr noundef %46)
  call void @llvm.lifetime.end.p0(i64 856, ptr nonnull %11)
  br label %343

343:
  %344 = phi ptr [ null, %19 ], [ %43, %35 ], [ %342, %341 ], [ %56, %48 ]
  ret ptr %344
}

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

define internal ptr @work(ptr nocapture noundef %0) {
  %2 = alloca %struct.Columns, align 8
  %3 = load ptr, ptr %0, align 8
  %4 = load i64, ptr %3, align 8
  %5 = icmp sgt i64 %4, 0
  br i1 %5, label %13, label %9

6:
  %7 = shl i64 %18, 6
  %8 = add i64 %7, 64
  br label %9

9:
  %10 = phi i64 [ 64, %1 ], [ %8, %6 ]
  %11 = tail call noalias ptr @calloc(i64 noundef 1, i64 noundef %10)
  %12 = icmp eq ptr %11, null
  br i1 %12, label %21, label %23

13:
  %14 = phi i64 [ %18, %13 ], [ 0, %1 ]
  %15 = phi i64 [ %19, %13 ], [ 0, %1 ]
  %16 = getelementptr inbounds %struct.Operation, ptr %3, i64 0, i32 1, i64 %15, i32 4
  %17 = load i64, ptr %16, align 8
  %18 = tail call i64 @llvm.smax.i64(i64 %17, i64 %14)
  %19 = add nuw nsw i64 %15, 1
  %20 = icmp eq i64 %19, %4
  br i1 %20, label %6, label %13

21:
  %22 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 21
  store i32 1, ptr %22, align 8
  br label %569

23:
  %24 = tail call i64 @enter_float_mode()
  call void @llvm.lifetime.start.p0(i64 328, ptr nonnull %2)
  %25 = ptrtoint ptr %11 to i64
  %26 = add i64 %25, 63
  %27 = and i64 %26, -64
  %28 = inttoptr i64 %27 to ptr
  store ptr %28, ptr %2, align 8
  %29 = getelementptr inbounds i8, ptr %2, i64 8
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(64) %29, i8 -1, i64 64, i1 false)
  %30 = load i64, ptr %3, align 8
  %31 = icmp sgt i64 %30, 0
  br i1 %31, label %32, label %45

32:
  %33 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 5
  %34 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 18
  %35 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 8
  %36 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 7
  %37 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 9
  %38 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 10
  %39 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 1
  %40 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 13
  %41 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 17
  %42 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 16
  %43 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 14
  %44 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 15
  br label %46

45:
  tail call void @leave_float_mode(i64 noundef %24)
  tail call void @free(ptr noundef %11)
  call void @llvm.lifetime.end.p0(i64 328, ptr nonnull %2)
  br label %569

46:
  %47 = phi i64 [ 0, %32 ], [ %566, %565 ]
  %48 = load ptr, ptr %0, align 8
  %49 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47
  %50 = load i64, ptr %33, align 8
  %51 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 19, i64 %47
  %52 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 20, i64 %47
  %53 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 8
  %54 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 1
  %55 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 3
  %56 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 11
  %57 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 12
  %58 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 13
  %59 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 14
  %60 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 7
  %61 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 2
  %62 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 6
  %63 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 9
  %64 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 15
  %65 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 10
  %66 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 16
  br label %67

67:
  %68 = phi i8 [ 0, %46 ], [ %564, %563 ]
  br label %71

69:
  %70 = icmp eq i8 %217, 0
  br i1 %70, label %230, label %227

71:
  %72 = phi i64 [ 0, %67 ], [ %225, %216 ]
  %73 = phi i8 [ %68, %67 ], [ %217, %216 ]
  %74 = phi i8 [ 0, %67 ], [ %224, %216 ]
  %75 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %72
  %76 = load i64, ptr %75, align 8
  %77 = icmp slt i64 %76, 0
  br i1 %77, label %78, label %216

78:
  %79 = atomicrmw add ptr %51, i64 1 monotonic, align 8
  %80 = load i64, ptr %52, align 8
  %81 = icmp slt i64 %79, %80
  br i1 %81, label %82, label %216

82:
  %83 = load ptr, ptr %0, align 8
  %84 = load ptr, ptr %34, align 8
  %85 = getelementptr inbounds %struct.Turn, ptr %84, i64 %79, i32 1
  %86 = load i64, ptr %85, align 8
  %87 = getelementptr inbounds %struct.Turn, ptr %84, i64 %79, i32 2
  %88 = load i64, ptr %87, align 8
  %89 = getelementptr inbounds %struct.Operation, ptr %83, i64 0, i32 5
  %90 = load i64, ptr %89, align 8
  %91 = icmp sgt i64 %90, 0
  br i1 %91, label %95, label %92

92:
  %93 = load i64, ptr %36, align 8
  %94 = icmp sgt i64 %93, 0
  br i1 %94, label %112, label %107

95:
  %96 = phi i64 [ %104, %95 ], [ 0, %82 ]
  %97 = load ptr, ptr %35, align 8
  %98 = load ptr, ptr %97, align 8
  %99 = getelementptr inbounds double, ptr %98, i64 %96
  %100 = load double, ptr %99, align 8
  %101 = shl nsw i64 %96, 3
  %102 = add nuw nsw i64 %101, %72
  %103 = getelementptr inbounds double, ptr %28, i64 %102
  store double %100, ptr %103, align 8
  %104 = add nuw nsw i64 %96, 1
  %105 = load i64, ptr %89, align 8
  %106 = icmp slt i64 %104, %105
  br i1 %106, label %95, label %92

107:
  %108 = load i64, ptr %89, align 8
  %109 = getelementptr inbounds %struct.Operation, ptr %83, i64 0, i32 1, i64 %47, i32 5
  %110 = load i64, ptr %109, align 8
  %111 = icmp slt i64 %108, %110
  br i1 %111, label %164, label %154

112:
  %113 = phi i64 [ %151, %145 ], [ 0, %92 ]
  %114 = load ptr, ptr %37, align 8
  %115 = load ptr, ptr %114, align 8
  %116 = getelementptr inbounds double, ptr %115, i64 %113
  %117 = load double, ptr %116, align 8
  %118 = fptosi double %117 to i64
  %119 = load ptr, ptr %38, align 8
  %120 = getelementptr inbounds %struct.Operand, ptr %119, i64 %113
  %121 = load i64, ptr %39, align 8
  %122 = icmp eq i64 %121, 1
  %123 = load ptr, ptr %120, align 8
  br i1 %122, label %124, label %129

124:
  %125 = getelementptr inbounds %struct.Operand, ptr %119, i64 %113, i32 1
  %126 = load i64, ptr %125, align 8
  %127 = mul nsw i64 %126, %86
  %128 = getelementptr inbounds double, ptr %123, i64 %127
  br label %145

129:
  %130 = icmp sgt i64 %121, 0
  br i1 %130, label %131, label %145

131:
  %132 = phi i64 [ %135, %131 ], [ %121, %129 ]
  %133 = phi ptr [ %142, %131 ], [ %123, %129 ]
  %134 = phi i64 [ %143, %131 ], [ %86, %129 ]
  %135 = add nsw i64 %132, -1
  %136 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %135
  %137 = load i64, ptr %136, align 8
  %138 = srem i64 %134, %137
  %139 = getelementptr inbounds %struct.Operand, ptr %119, i64 %113, i32 1, i64 %135
  %140 = load i64, ptr %139, align 8
  %141 = mul nsw i64 %140, %138
  %142 = getelementptr inbounds double, ptr %133, i64 %141
  %143 = sdiv i64 %134, %137
  %144 = icmp sgt i64 %132, 1
  br i1 %144, label %131, label %145

145:
  %146 = phi ptr [ %128, %124 ], [ %123, %129 ], [ %142, %131 ]
  %147 = load double, ptr %146, align 8
  %148 = shl nsw i64 %118, 3
  %149 = add nsw i64 %148, %72
  %150 = getelementptr inbounds double, ptr %28, i64 %149
  store double %147, ptr %150, align 8
  %151 = add nuw nsw i64 %113, 1
  %152 = load i64, ptr %36, align 8
  %153 = icmp slt i64 %151, %152
  br i1 %153, label %112, label %107

154:
  %155 = load ptr, ptr %0, align 8
  %156 = getelementptr inbounds %struct.Operation, ptr %155, i64 0, i32 6
  %157 = load i64, ptr %156, align 8
  %158 = sub nsw i64 %157, %88
  %159 = load i64, ptr %33, align 8
  %160 = tail call i64 @llvm.smin.i64(i64 %158, i64 %159)
  %161 = icmp sgt i64 %160, 0
  br i1 %161, label %162, label %172

162:
  %163 = getelementptr inbounds %struct.Operation, ptr %83, i64 0, i32 6
  br label %178

164:
  %165 = phi i64 [ %169, %164 ], [ %108, %107 ]
  %166 = shl nsw i64 %165, 3
  %167 = add nsw i64 %166, %72
  %168 = getelementptr inbounds double, ptr %28, i64 %167
  store double 0.000000e+00, ptr %168, align 8
  %169 = add nsw i64 %165, 1
  %170 = load i64, ptr %109, align 8
  %171 = icmp slt i64 %169, %170
  br i1 %171, label %164, label %154

172:
  store i64 %86, ptr %75, align 8
  %173 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 2, i64 %72
  store i64 %88, ptr %173, align 8
  %174 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 5, i64 %72
  store i64 0, ptr %174, align 8
  %175 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %72
  store i64 0, ptr %175, align 8
  %176 = load i64, ptr %53, align 8
  %177 = icmp sgt i64 %176, -1
  br i1 %177, label %205, label %211

178:
  %179 = phi i64 [ 0, %162 ], [ %197, %178 ]
  %180 = load ptr, ptr %40, align 8
  %181 = load ptr, ptr %180, align 8
  %182 = add nsw i64 %179, %88
  %183 = getelementptr inbounds double, ptr %181, i64 %182
  %184 = load double, ptr %183, align 8
  %185 = fptosi double %184 to i64
  %186 = load i64, ptr %109, align 8
  %187 = load i64, ptr %89, align 8
  %188 = sub nsw i64 %186, %187
  %189 = load i64, ptr %163, align 8
  %190 = sdiv i64 %188, %189
  %191 = mul nsw i64 %190, %179
  %192 = add i64 %187, %185
  %193 = add i64 %192, %191
  %194 = shl nsw i64 %193, 3
  %195 = add nsw i64 %194, %72
  %196 = getelementptr inbounds double, ptr %28, i64 %195
  store double 1.000000e+00, ptr %196, align 8
  %197 = add nuw nsw i64 %179, 1
  %198 = load ptr, ptr %0, align 8
  %199 = getelementptr inbounds %struct.Operation, ptr %198, i64 0, i32 6
  %200 = load i64, ptr %199, align 8
  %201 = sub nsw i64 %200, %88
  %202 = load i64, ptr %33, align 8
  %203 = tail call i64 @llvm.smin.i64(i64 %201, i64 %202)
  %204 = icmp slt i64 %197, %203
  br i1 %204, label %178, label %172

205:
  %206 = shl nsw i64 %176, 3
  %207 = add nsw i64 %206, %72
  %208 = getelementptr inbounds double, ptr %28, i64 %207
  %209 = load double, ptr %208, align 8
  %210 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 3, i64 %72
  store double %209, ptr %210, align 8
  br label %211

211:
  %212 = trunc i64 %72 to i32
  %213 = shl nuw i32 1, %212
  %214 = trunc i32 %213 to i8
  %215 = or i8 %73, %214
  br label %216

216:
  %217 = phi i8 [ %215, %211 ], [ %73, %71 ], [ %73, %78 ]
  %218 = load i64, ptr %75, align 8
  %219 = trunc i64 %72 to i32
  %220 = shl nuw i32 1, %219
  %221 = trunc i32 %220 to i8
  %222 = icmp slt i64 %218, 0
  %223 = select i1 %222, i8 0, i8 %221
  %224 = or i8 %223, %74
  %225 = add nuw nsw i64 %72, 1
  %226 = icmp eq i64 %225, 8
  br i1 %226, label %69, label %71

227:
  %228 = load ptr, ptr %49, align 8
  %229 = tail call zeroext i8 %228(ptr noundef %28, i8 noundef zeroext %217, i64 noundef %50)
  br label %230

230:
  %231 = icmp eq i8 %224, 0
  br i1 %231, label %563, label %232

232:
  %233 = zext i8 %224 to i32
  br label %234

234:
  %235 = load ptr, ptr %54, align 8
  %236 = tail call zeroext i8 %235(ptr noundef %28, i8 noundef zeroext %224, i64 noundef %50)
  %237 = xor i8 %236, -1
  %238 = and i8 %224, %237
  %239 = load ptr, ptr %55, align 8
  %240 = icmp eq ptr %239, null
  br i1 %240, label %429, label %241

241:
  %242 = load i64, ptr %56, align 8
  %243 = shl nsw i64 %242, 3
  %244 = getelementptr inbounds double, ptr %28, i64 %243
  %245 = load i64, ptr %57, align 8
  %246 = shl nsw i64 %245, 3
  %247 = getelementptr inbounds double, ptr %28, i64 %246
  %248 = zext i8 %238 to i32
  br label %251

249:
  %250 = icmp eq i8 %324, 0
  br i1 %250, label %429, label %330

251:
  %252 = phi i64 [ 0, %241 ], [ %328, %327 ]
  %253 = phi i8 [ 0, %241 ], [ %329, %327 ]
  %254 = trunc i64 %252 to i32
  %255 = shl nuw i32 1, %254
  %256 = and i32 %255, %233
  %257 = icmp eq i32 %256, 0
  br i1 %257, label %323, label %258

258:
  %259 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 5, i64 %252
  %260 = load i64, ptr %259, align 8
  %261 = load ptr, ptr %41, align 8
  %262 = icmp eq ptr %261, null
  br i1 %262, label %275, label %263

263:
  %264 = icmp eq i64 %260, 0
  br i1 %264, label %310, label %265

265:
  %266 = load i64, ptr %56, align 8
  %267 = shl nsw i64 %266, 3
  %268 = add nsw i64 %267, %252
  %269 = getelementptr inbounds double, ptr %28, i64 %268
  %270 = load double, ptr %269, align 8
  %271 = getelementptr inbounds %struct.Course, ptr %261, i64 0, i32 3
  %272 = load double, ptr %271, align 8
  %273 = fcmp ogt double %270, %272
  %274 = select i1 %273, double %270, double 0x7FF0000000000000
  br label %310

275:
  %276 = load i64, ptr %42, align 8
  %277 = icmp eq i64 %260, %276
  br i1 %277, label %310, label %278

278:
  %279 = load ptr, ptr %43, align 8
  %280 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %252
  %281 = load i64, ptr %280, align 8
  %282 = load i64, ptr %39, align 8
  %283 = icmp eq i64 %282, 1
  %284 = load ptr, ptr %279, align 8
  br i1 %283, label %285, label %290

285:
  %286 = getelementptr inbounds %struct.Operand, ptr %279, i64 0, i32 1
  %287 = load i64, ptr %286, align 8
  %288 = mul nsw i64 %287, %281
  %289 = getelementptr inbounds double, ptr %284, i64 %288
  br label %306

290:
  %291 = icmp sgt i64 %282, 0
  br i1 %291, label %292, label %306

292:
  %293 = phi i64 [ %296, %292 ], [ %282, %290 ]
  %294 = phi ptr [ %303, %292 ], [ %284, %290 ]
  %295 = phi i64 [ %304, %292 ], [ %281, %290 ]
  %296 = add nsw i64 %293, -1
  %297 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %296
  %298 = load i64, ptr %297, align 8
  %299 = srem i64 %295, %298
  %300 = getelementptr inbounds %struct.Operand, ptr %279, i64 0, i32 1, i64 %296
  %301 = load i64, ptr %300, align 8
  %302 = mul nsw i64 %301, %299
  %303 = getelementptr inbounds double, ptr %294, i64 %302
  %304 = sdiv i64 %295, %298
  %305 = icmp sgt i64 %293, 1
  br i1 %305, label %292, label %306

306:
  %307 = phi ptr [ %289, %285 ], [ %284, %290 ], [ %303, %292 ]
  %308 = getelementptr inbounds double, ptr %307, i64 %260
  %309 = load double, ptr %308, align 8
  br label %310

310:
  %311 = phi double [ %309, %306 ], [ %274, %265 ], [ 0.000000e+00, %263 ], [ 0x7FF0000000000000, %275 ]
  %312 = getelementptr inbounds double, ptr %247, i64 %252
  store double %311, ptr %312, align 8
  %313 = getelementptr inbounds double, ptr %244, i64 %252
  %314 = load double, ptr %313, align 8
  %315 = and i32 %255, %248
  %316 = icmp eq i32 %315, 0
  %317 = select i1 %316, double 1.000000e+00, double 0x3FF000010C6F7A0B
  %318 = fmul double %317, %314
  %319 = fcmp ugt double %311, %318
  %320 = trunc i32 %255 to i8
  %321 = select i1 %319, i8 0, i8 %320
  %322 = or i8 %321, %253
  br label %323

323:
  %324 = phi i8 [ %322, %310 ], [ %253, %251 ]
  %325 = add nuw nsw i64 %252, 1
  %326 = icmp eq i64 %325, 8
  br i1 %326, label %249, label %327

327:
  %328 = phi i64 [ %325, %323 ], [ 0, %426 ]
  %329 = phi i8 [ %324, %323 ], [ 0, %426 ]
  br label %251

330:
  %331 = load ptr, ptr %55, align 8
  %332 = load i64, ptr %33, align 8
  %333 = tail call zeroext i8 %331(ptr noundef %28, i8 noundef zeroext %324, i64 noundef %332)
  %334 = zext i8 %324 to i32
  br label %335

335:
  %336 = phi i64 [ 0, %330 ], [ %427, %426 ]
  %337 = trunc i64 %336 to i32
  %338 = shl nuw i32 1, %337
  %339 = and i32 %338, %334
  %340 = icmp eq i32 %339, 0
  br i1 %340, label %426, label %341

341:
  %342 = load i64, ptr %58, align 8
  %343 = shl nsw i64 %342, 3
  %344 = getelementptr inbounds double, ptr %28, i64 %343
  %345 = getelementptr inbounds double, ptr %344, i64 %336
  %346 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 5, i64 %336
  %347 = load i64, ptr %346, align 8
  %348 = load ptr, ptr %41, align 8
  %349 = icmp eq ptr %348, null
  br i1 %349, label %378, label %350

350:
  %351 = load i64, ptr %57, align 8
  %352 = shl nsw i64 %351, 3
  %353 = add nsw i64 %352, %336
  %354 = getelementptr inbounds double, ptr %28, i64 %353
  %355 = load double, ptr %354, align 8
  %356 = getelementptr inbounds %struct.Course, ptr %348, i64 0, i32 3
  store double %355, ptr %356, align 8
  %357 = add nsw i64 %347, 1
  %358 = getelementptr inbounds %struct.Course, ptr %348, i64 0, i32 2
  store i64 %357, ptr %358, align 8
  %359 = getelementptr inbounds %struct.Course, ptr %348, i64 0, i32 1
  %360 = load i64, ptr %359, align 8
  %361 = icmp slt i64 %347, %360
  br i1 %361, label %362, label %424

362:
  %363 = load i64, ptr %59, align 8
  %364 = icmp sgt i64 %363, 0
  br i1 %364, label %365, label %424

365:
  %366 = phi i64 [ %375, %365 ], [ 0, %362 ]
  %367 = shl nsw i64 %366, 3
  %368 = getelementptr inbounds double, ptr %345, i64 %367
  %369 = load double, ptr %368, align 8
  %370 = load ptr, ptr %348, align 8
  %371 = load i64, ptr %359, align 8
  %372 = mul nsw i64 %371, %366
  %373 = add nsw i64 %372, %347
  %374 = getelementptr inbounds double, ptr %370, i64 %373
  store double %369, ptr %374, align 8
  %375 = add nuw nsw i64 %366, 1
  %376 = load i64, ptr %59, align 8
  %377 = icmp slt i64 %375, %376
  br i1 %377, label %365, label %424

378:
  %379 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %336
  %380 = load i64, ptr %379, align 8
  %381 = load i64, ptr %42, align 8
  %382 = mul nsw i64 %381, %380
  %383 = add nsw i64 %382, %347
  %384 = load ptr, ptr %44, align 8
  %385 = load i64, ptr %60, align 8
  %386 = getelementptr inbounds ptr, ptr %384, i64 %385
  %387 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 2, i64 %336
  %388 = load i64, ptr %387, align 8
  %389 = load i64, ptr %59, align 8
  %390 = load ptr, ptr %0, align 8
  %391 = getelementptr inbounds %struct.Operation, ptr %390, i64 0, i32 6
  %392 = load i64, ptr %391, align 8
  %393 = add nsw i64 %392, 1
  %394 = sdiv i64 %389, %393
  %395 = sub nsw i64 %392, %388
  %396 = load i64, ptr %33, align 8
  %397 = tail call i64 @llvm.smin.i64(i64 %395, i64 %396)
  %398 = add nsw i64 %397, 1
  %399 = mul nsw i64 %398, %394
  %400 = icmp sgt i64 %399, 0
  br i1 %400, label %401, label %424

401:
  %402 = mul nsw i64 %394, %388
  br label %403

403:
  %404 = phi i64 [ 0, %401 ], [ %414, %403 ]
  %405 = shl nsw i64 %404, 3
  %406 = getelementptr inbounds double, ptr %345, i64 %405
  %407 = load double, ptr %406, align 8
  %408 = icmp slt i64 %404, %394
  %409 = select i1 %408, i64 0, i64 %402
  %410 = add nsw i64 %409, %404
  %411 = getelementptr inbounds ptr, ptr %386, i64 %410
  %412 = load ptr, ptr %411, align 8
  %413 = getelementptr inbounds double, ptr %412, i64 %383
  store double %407, ptr %413, align 8
  %414 = add nuw nsw i64 %404, 1
  %415 = load ptr, ptr %0, align 8
  %416 = getelementptr inbounds %struct.Operation, ptr %415, i64 0, i32 6
  %417 = load i64, ptr %416, align 8
  %418 = sub nsw i64 %417, %388
  %419 = load i64, ptr %33, align 8
  %420 = tail call i64 @llvm.smin.i64(i64 %418, i64 %419)
  %421 = add nsw i64 %420, 1
  %422 = mul nsw i64 %421, %394
  %423 = icmp slt i64 %414, %422
  br i1 %423, label %403, label %424

424:
  %425 = add nsw i64 %347, 1
  store i64 %425, ptr %346, align 8
  br label %426

426:
  %427 = add nuw nsw i64 %336, 1
  %428 = icmp eq i64 %427, 8
  br i1 %428, label %327, label %335

429:
  %430 = icmp eq i8 %238, 0
  br i1 %430, label %234, label %431

431:
  %432 = load ptr, ptr %61, align 8
  %433 = tail call zeroext i8 %432(ptr noundef %28, i8 noundef zeroext %238, i64 noundef %50)
  %434 = zext i8 %238 to i32
  br label %435

435:
  %436 = phi i64 [ 0, %431 ], [ %561, %559 ]
  %437 = phi i8 [ 0, %431 ], [ %560, %559 ]
  %438 = trunc i64 %436 to i32
  %439 = shl nuw i32 1, %438
  %440 = and i32 %439, %434
  %441 = icmp eq i32 %440, 0
  br i1 %441, label %559, label %442

442:
  %443 = load i64, ptr %53, align 8
  %444 = icmp slt i64 %443, 0
  br i1 %444, label %480, label %445

445:
  %446 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %436
  %447 = load i64, ptr %446, align 8
  %448 = icmp eq i64 %447, 7
  br i1 %448, label %480, label %449

449:
  %450 = load i64, ptr %62, align 8
  %451 = shl nsw i64 %450, 3
  %452 = getelementptr inbounds double, ptr %28, i64 %451
  %453 = getelementptr inbounds double, ptr %452, i64 %436
  %454 = load i64, ptr %63, align 8
  %455 = shl nsw i64 %454, 3
  %456 = getelementptr inbounds double, ptr %453, i64 %455
  %457 = load double, ptr %456, align 8
  %458 = load double, ptr %64, align 8
  %459 = fcmp une double %457, %458
  br i1 %459, label %480, label %460

460:
  %461 = load i64, ptr %65, align 8
  %462 = shl nsw i64 %461, 3
  %463 = getelementptr inbounds double, ptr %453, i64 %462
  %464 = load double, ptr %463, align 8
  %465 = load double, ptr %66, align 8
  %466 = fcmp ult double %464, %465
  br i1 %466, label %467, label %480

467:
  %468 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 3, i64 %436
  %469 = load double, ptr %468, align 8
  %470 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %47, i32 17, i64 %447
  %471 = load double, ptr %470, align 8
  %472 = fmul double %469, %471
  %473 = shl nsw i64 %443, 3
  %474 = add nsw i64 %473, %436
  %475 = getelementptr inbounds double, ptr %28, i64 %474
  store double %472, ptr %475, align 8
  %476 = add nsw i64 %447, 1
  store i64 %476, ptr %446, align 8
  %477 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 5, i64 %436
  store i64 0, ptr %477, align 8
  %478 = trunc i32 %439 to i8
  %479 = or i8 %437, %478
  br label %559

480:
  %481 = load i64, ptr %62, align 8
  %482 = shl nsw i64 %481, 3
  %483 = getelementptr inbounds double, ptr %28, i64 %482
  %484 = getelementptr inbounds double, ptr %483, i64 %436
  %485 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %436
  %486 = load i64, ptr %485, align 8
  %487 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 2, i64 %436
  %488 = load i64, ptr %487, align 8
  %489 = load ptr, ptr %0, align 8
  %490 = getelementptr inbounds %struct.Operation, ptr %489, i64 0, i32 6
  %491 = load i64, ptr %490, align 8
  %492 = sub nsw i64 %491, %488
  %493 = load i64, ptr %33, align 8
  %494 = tail call i64 @llvm.smin.i64(i64 %492, i64 %493)
  %495 = add nsw i64 %494, 1
  %496 = load i64, ptr %60, align 8
  %497 = add nsw i64 %491, 1
  %498 = sdiv i64 %496, %497
  %499 = mul nsw i64 %498, %495
  %500 = icmp sgt i64 %499, 0
  br i1 %500, label %501, label %503

501:
  %502 = mul nsw i64 %498, %488
  br label %506

503:
  %504 = load ptr, ptr %41, align 8
  %505 = icmp eq ptr %504, null
  br i1 %505, label %520, label %558

506:
  %507 = phi i64 [ 0, %501 ], [ %518, %506 ]
  %508 = shl nsw i64 %507, 3
  %509 = getelementptr inbounds double, ptr %484, i64 %508
  %510 = load double, ptr %509, align 8
  %511 = load ptr, ptr %44, align 8
  %512 = icmp slt i64 %507, %498
  %513 = select i1 %512, i64 0, i64 %502
  %514 = add nsw i64 %513, %507
  %515 = getelementptr inbounds ptr, ptr %511, i64 %514
  %516 = load ptr, ptr %515, align 8
  %517 = getelementptr inbounds double, ptr %516, i64 %486
  store double %510, ptr %517, align 8
  %518 = add nuw nsw i64 %507, 1
  %519 = icmp eq i64 %518, %499
  br i1 %519, label %503, label %506

520:
  %521 = load ptr, ptr %44, align 8
  %522 = load i64, ptr %60, align 8
  %523 = getelementptr inbounds ptr, ptr %521, i64 %522
  %524 = load i64, ptr %59, align 8
  %525 = load ptr, ptr %0, align 8
  %526 = getelementptr inbounds %struct.Operation, ptr %525, i64 0, i32 6
  %527 = load i64, ptr %526, align 8
  %528 = add nsw i64 %527, 1
  %529 = sdiv i64 %524, %528
  %530 = mul nsw i64 %529, %495
  %531 = icmp sgt i64 %530, 0
  br i1 %531, label %532, label %558

532:
  %533 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 5, i64 %436
  %534 = mul nsw i64 %529, %488
  %535 = load i64, ptr %533, align 8
  br label %536

536:
  %537 = phi i64 [ 0, %532 ], [ %546, %545 ]
  %538 = load i64, ptr %42, align 8
  %539 = icmp slt i64 %535, %538
  br i1 %539, label %540, label %545

540:
  %541 = icmp slt i64 %537, %529
  %542 = select i1 %541, i64 0, i64 %534
  %543 = add nsw i64 %542, %537
  %544 = getelementptr inbounds ptr, ptr %523, i64 %543
  br label %548

545:
  %546 = add nuw nsw i64 %537, 1
  %547 = icmp eq i64 %546, %530
  br i1 %547, label %558, label %536

548:
  %549 = phi i64 [ %538, %540 ], [ %556, %548 ]
  %550 = phi i64 [ %535, %540 ], [ %555, %548 ]
  %551 = load ptr, ptr %544, align 8
  %552 = mul nsw i64 %549, %486
  %553 = add nsw i64 %552, %550
  %554 = getelementptr inbounds double, ptr %551, i64 %553
  store double 0x7FF8000000000000, ptr %554, align 8
  %555 = add nsw i64 %550, 1
  %556 = load i64, ptr %42, align 8
  %557 = icmp slt i64 %555, %556
  br i1 %557, label %548, label %545

558:
  store i64 -1, ptr %485, align 8
  br label %559

559:
  %560 = phi i8 [ %479, %467 ], [ %437, %558 ], [ %437, %435 ]
  %561 = add nuw nsw i64 %436, 1
  %562 = icmp eq i64 %561, 8
  br i1 %562, label %563, label %435

563:
  %564 = phi i8 [ %68, %230 ], [ %560, %559 ]
  br i1 %231, label %565, label %67

565:
  %566 = add nuw nsw i64 %47, 1
  %567 = load i64, ptr %3, align 8
  %568 = icmp slt i64 %566, %567
  br i1 %568, label %46, label %45

569:
  ret ptr null
}

define internal i32 @work_on_windows(ptr nocapture noundef %0) {
  %2 = tail call ptr @work(ptr noundef %0)
  ret i32 0
}

declare i64 @llvm.smin.i64(i64, i64)

declare i64 @llvm.smax.i64(i64, i64)

