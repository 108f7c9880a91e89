; Made from driver.c by 'make driver'; sha256 f1c0082599414d16a36d18b690c6d5df9546d465568801ea0623f1260dc0d190

%struct.Operation = type { i64, [32 x %struct.Program], [32 x i64], ptr, ptr, i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr }
%struct.Program = type { ptr, ptr, ptr, ptr, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, double, double, [7 x double], ptr, ptr, ptr, ptr, i64, i64 }
%struct.Operand = type { ptr, [24 x i64] }
%struct.Job = type { ptr, i64, [24 x i64], i64, i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, i64, ptr, ptr, [32 x i64], [32 x i64], i32, i32 }
%struct.Rows = type { ptr, i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr }
%struct.Turn = type { double, i64, i64 }
%struct.anon = type { i64, ptr, ptr, i32 }
%struct.Tape = type { ptr, i64, i64 }
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
  %2 = alloca [8 x %struct.Tape], align 16
  %3 = alloca %struct.Columns, align 8
  %4 = load ptr, ptr %0, align 8
  %5 = load i64, ptr %4, align 8
  %6 = icmp sgt i64 %5, 0
  br i1 %6, label %14, label %10

7:
  %8 = shl i64 %19, 6
  %9 = add i64 %8, 64
  br label %10

10:
  %11 = phi i64 [ 64, %1 ], [ %9, %7 ]
  %12 = tail call noalias ptr @calloc(i64 noundef 1, i64 noundef %11)
  %13 = icmp eq ptr %12, null
  br i1 %13, label %22, label %24

14:
  %15 = phi i64 [ %19, %14 ], [ 0, %1 ]
  %16 = phi i64 [ %20, %14 ], [ 0, %1 ]
  %17 = getelementptr inbounds %struct.Operation, ptr %4, i64 0, i32 1, i64 %16, i32 4
  %18 = load i64, ptr %17, align 8
  %19 = tail call i64 @llvm.smax.i64(i64 %18, i64 %15)
  %20 = add nuw nsw i64 %16, 1
  %21 = icmp eq i64 %20, %5
  br i1 %21, label %7, label %14

22:
  %23 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 21
  store i32 1, ptr %23, align 8
  br label %667

24:
  %25 = tail call i64 @enter_float_mode()
  call void @llvm.lifetime.start.p0(i64 328, ptr nonnull %3)
  %26 = ptrtoint ptr %12 to i64
  %27 = add i64 %26, 63
  %28 = and i64 %27, -64
  %29 = inttoptr i64 %28 to ptr
  store ptr %29, ptr %3, align 8
  %30 = getelementptr inbounds i8, ptr %3, i64 8
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(64) %30, i8 -1, i64 64, i1 false)
  %31 = load i64, ptr %4, align 8
  %32 = icmp sgt i64 %31, 0
  br i1 %32, label %33, label %42

33:
  %34 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 21
  %35 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 5
  %36 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 17
  %37 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 16
  %38 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 14
  %39 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 1
  %40 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 15
  %41 = getelementptr inbounds i8, ptr %3, i64 8
  br label %43

42:
  tail call void @leave_float_mode(i64 noundef %25)
  tail call void @free(ptr noundef %12)
  call void @llvm.lifetime.end.p0(i64 328, ptr nonnull %3)
  br label %667

43:
  %44 = phi i64 [ 0, %33 ], [ %664, %663 ]
  %45 = getelementptr inbounds %struct.Operation, ptr %4, i64 0, i32 1, i64 %44, i32 19
  %46 = load ptr, ptr %45, align 8
  %47 = icmp eq ptr %46, null
  %48 = load ptr, ptr %0, align 8
  %49 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44
  br i1 %47, label %340, label %50

50:
  call void @llvm.lifetime.start.p0(i64 192, ptr nonnull %2)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 16 dereferenceable(192) %2, i8 0, i64 192, i1 false)
  %51 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 8
  %52 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 23
  %53 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 22
  %54 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 21
  %55 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 1
  %56 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 2
  %57 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 6
  %58 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 9
  %59 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 15
  %60 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 10
  %61 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 16
  %62 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 18
  %63 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 19
  %64 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 20
  br label %65

65:
  %66 = phi i64 [ 0, %50 ], [ %94, %93 ]
  %67 = phi i8 [ 0, %50 ], [ %95, %93 ]
  %68 = trunc i64 %66 to i32
  %69 = call fastcc i32 @take_lane(ptr noundef nonnull %0, i64 noundef %44, ptr noundef nonnull %3, i32 noundef %68)
  %70 = icmp eq i32 %69, 0
  br i1 %70, label %71, label %74

71:
  %72 = phi i8 [ %77, %90 ], [ %67, %65 ]
  %73 = icmp eq i8 %72, 0
  br i1 %73, label %332, label %96

74:
  %75 = shl nuw i32 1, %68
  %76 = trunc i32 %75 to i8
  %77 = or i8 %67, %76
  %78 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %66
  store i64 0, ptr %78, align 8
  %79 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 4, i64 %66
  store i64 0, ptr %79, align 8
  %80 = getelementptr inbounds [8 x %struct.Tape], ptr %2, i64 0, i64 %66, i32 1
  store i64 0, ptr %80, align 8
  %81 = load i64, ptr %51, align 8
  %82 = icmp sgt i64 %81, -1
  br i1 %82, label %83, label %90

83:
  %84 = load ptr, ptr %3, align 8
  %85 = shl nsw i64 %81, 3
  %86 = add nsw i64 %85, %66
  %87 = getelementptr inbounds double, ptr %84, i64 %86
  %88 = load double, ptr %87, align 8
  %89 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 3, i64 %66
  store double %88, ptr %89, align 8
  br label %90

90:
  %91 = add nuw nsw i64 %66, 1
  %92 = icmp eq i64 %91, 8
  br i1 %92, label %71, label %93

93:
  %94 = phi i64 [ %91, %90 ], [ 0, %329 ]
  %95 = phi i8 [ %77, %90 ], [ 0, %329 ]
  br label %65

96:
  %97 = load ptr, ptr %3, align 8
  %98 = load i64, ptr %52, align 8
  %99 = shl nsw i64 %98, 3
  %100 = getelementptr inbounds double, ptr %97, i64 %99
  br label %101

101:
  %102 = phi i8 [ %72, %96 ], [ %252, %250 ]
  %103 = phi i8 [ %72, %96 ], [ %251, %250 ]
  %104 = icmp eq i8 %102, 0
  br i1 %104, label %108, label %105

105:
  %106 = load ptr, ptr %49, align 8
  %107 = tail call zeroext i8 %106(ptr noundef %97, i8 noundef zeroext %102, i64 noundef 0)
  br label %108

108:
  %109 = zext i8 %103 to i32
  br label %110

110:
  %111 = phi i64 [ 0, %108 ], [ %167, %166 ]
  %112 = trunc i64 %111 to i32
  %113 = shl nuw i32 1, %112
  %114 = and i32 %113, %109
  %115 = icmp eq i32 %114, 0
  br i1 %115, label %166, label %116

116:
  %117 = getelementptr inbounds %struct.Tape, ptr %2, i64 %111
  %118 = getelementptr inbounds %struct.Tape, ptr %2, i64 %111, i32 1
  %119 = load i64, ptr %118, align 8
  %120 = getelementptr inbounds %struct.Tape, ptr %2, i64 %111, i32 2
  %121 = load i64, ptr %120, align 8
  %122 = icmp eq i64 %119, %121
  br i1 %122, label %123, label %146

123:
  %124 = icmp eq i64 %121, 0
  %125 = shl nsw i64 %121, 1
  %126 = select i1 %124, i64 64, i64 %125
  %127 = load i64, ptr %53, align 8
  %128 = shl i64 %126, 3
  %129 = mul i64 %128, %127
  %130 = tail call noalias ptr @malloc(i64 noundef %129)
  %131 = icmp eq ptr %130, null
  br i1 %131, label %254, label %132

132:
  %133 = mul nsw i64 %127, %119
  %134 = icmp sgt i64 %133, 0
  br i1 %134, label %135, label %137

135:
  %136 = load ptr, ptr %117, align 8
  br label %139

137:
  %138 = load ptr, ptr %117, align 8
  tail call void @free(ptr noundef %138)
  store ptr %130, ptr %117, align 8
  store i64 %126, ptr %120, align 8
  br label %146

139:
  %140 = phi i64 [ 0, %135 ], [ %144, %139 ]
  %141 = getelementptr inbounds double, ptr %136, i64 %140
  %142 = load double, ptr %141, align 8
  %143 = getelementptr inbounds double, ptr %130, i64 %140
  store double %142, ptr %143, align 8
  %144 = add nuw nsw i64 %140, 1
  %145 = icmp eq i64 %144, %133
  br i1 %145, label %137, label %139

146:
  %147 = load ptr, ptr %117, align 8
  %148 = load i64, ptr %53, align 8
  %149 = load i64, ptr %118, align 8
  %150 = mul nsw i64 %149, %148
  %151 = getelementptr inbounds double, ptr %147, i64 %150
  %152 = icmp sgt i64 %148, 0
  br i1 %152, label %153, label %166

153:
  %154 = phi i64 [ %163, %153 ], [ 0, %146 ]
  %155 = load ptr, ptr %54, align 8
  %156 = getelementptr inbounds i64, ptr %155, i64 %154
  %157 = load i64, ptr %156, align 8
  %158 = shl nsw i64 %157, 3
  %159 = add nsw i64 %158, %111
  %160 = getelementptr inbounds double, ptr %97, i64 %159
  %161 = load double, ptr %160, align 8
  %162 = getelementptr inbounds double, ptr %151, i64 %154
  store double %161, ptr %162, align 8
  %163 = add nuw nsw i64 %154, 1
  %164 = load i64, ptr %53, align 8
  %165 = icmp slt i64 %163, %164
  br i1 %165, label %153, label %166

166:
  %167 = add nuw nsw i64 %111, 1
  %168 = icmp eq i64 %167, 8
  br i1 %168, label %169, label %110

169:
  %170 = load ptr, ptr %55, align 8
  %171 = tail call zeroext i8 %170(ptr noundef %97, i8 noundef zeroext %103, i64 noundef 0)
  br label %176

172:
  %173 = xor i8 %171, -1
  %174 = and i8 %103, %173
  %175 = icmp eq i8 %174, 0
  br i1 %175, label %250, label %190

176:
  %177 = phi i64 [ 0, %169 ], [ %188, %187 ]
  %178 = trunc i64 %177 to i32
  %179 = shl nuw i32 1, %178
  %180 = and i32 %179, %109
  %181 = icmp eq i32 %180, 0
  br i1 %181, label %187, label %182

182:
  %183 = getelementptr inbounds double, ptr %100, i64 %177
  %184 = load double, ptr %183, align 8
  %185 = fptosi double %184 to i64
  %186 = getelementptr inbounds %struct.Tape, ptr %2, i64 %177, i32 1
  store i64 %185, ptr %186, align 8
  br label %187

187:
  %188 = add nuw nsw i64 %177, 1
  %189 = icmp eq i64 %188, 8
  br i1 %189, label %172, label %176

190:
  %191 = load ptr, ptr %56, align 8
  %192 = tail call zeroext i8 %191(ptr noundef %97, i8 noundef zeroext %174, i64 noundef 0)
  %193 = zext i8 %174 to i32
  br label %198

194:
  %195 = xor i8 %174, -1
  %196 = or i8 %247, %195
  %197 = and i8 %196, %103
  br label %250

198:
  %199 = phi i64 [ 0, %190 ], [ %248, %246 ]
  %200 = phi i8 [ 0, %190 ], [ %247, %246 ]
  %201 = trunc i64 %199 to i32
  %202 = shl nuw i32 1, %201
  %203 = and i32 %202, %193
  %204 = icmp eq i32 %203, 0
  br i1 %204, label %246, label %205

205:
  %206 = load i64, ptr %51, align 8
  %207 = icmp slt i64 %206, 0
  br i1 %207, label %246, label %208

208:
  %209 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 4, i64 %199
  %210 = load i64, ptr %209, align 8
  %211 = icmp eq i64 %210, 7
  br i1 %211, label %246, label %212

212:
  %213 = load i64, ptr %57, align 8
  %214 = shl nsw i64 %213, 3
  %215 = getelementptr inbounds double, ptr %97, i64 %214
  %216 = getelementptr inbounds double, ptr %215, i64 %199
  %217 = load i64, ptr %58, align 8
  %218 = shl nsw i64 %217, 3
  %219 = getelementptr inbounds double, ptr %216, i64 %218
  %220 = load double, ptr %219, align 8
  %221 = load double, ptr %59, align 8
  %222 = fcmp une double %220, %221
  br i1 %222, label %246, label %223

223:
  %224 = load i64, ptr %60, align 8
  %225 = shl nsw i64 %224, 3
  %226 = getelementptr inbounds double, ptr %216, i64 %225
  %227 = load double, ptr %226, align 8
  %228 = load double, ptr %61, align 8
  %229 = fcmp oge double %227, %228
  %230 = icmp sgt i64 %210, 0
  %231 = select i1 %229, i1 %230, i1 false
  br i1 %231, label %246, label %232

232:
  %233 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 3, i64 %199
  %234 = load double, ptr %233, align 8
  %235 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 17, i64 %210
  %236 = load double, ptr %235, align 8
  %237 = fmul double %234, %236
  %238 = shl nsw i64 %206, 3
  %239 = add nsw i64 %238, %199
  %240 = getelementptr inbounds double, ptr %97, i64 %239
  store double %237, ptr %240, align 8
  %241 = add nsw i64 %210, 1
  store i64 %241, ptr %209, align 8
  %242 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %199
  store i64 0, ptr %242, align 8
  %243 = trunc i32 %202 to i8
  %244 = or i8 %200, %243
  %245 = getelementptr inbounds %struct.Tape, ptr %2, i64 %199, i32 1
  store i64 0, ptr %245, align 8
  br label %246

246:
  %247 = phi i8 [ %244, %232 ], [ %200, %198 ], [ %200, %223 ], [ %200, %212 ], [ %200, %208 ], [ %200, %205 ]
  %248 = add nuw nsw i64 %199, 1
  %249 = icmp eq i64 %248, 8
  br i1 %249, label %194, label %198

250:
  %251 = phi i8 [ %197, %194 ], [ %103, %172 ]
  %252 = phi i8 [ %247, %194 ], [ 0, %172 ]
  %253 = icmp eq i8 %251, 0
  br i1 %253, label %255, label %101

254:
  store i32 1, ptr %34, align 8
  br label %332

255:
  %256 = load ptr, ptr %62, align 8
  %257 = tail call zeroext i8 %256(ptr noundef %97, i8 noundef zeroext %72, i64 noundef 0)
  %258 = zext i8 %72 to i32
  br label %261

259:
  %260 = icmp sgt i64 %273, 0
  br i1 %260, label %276, label %320

261:
  %262 = phi i64 [ 0, %255 ], [ %274, %272 ]
  %263 = phi i64 [ 0, %255 ], [ %273, %272 ]
  %264 = trunc i64 %262 to i32
  %265 = shl nuw i32 1, %264
  %266 = and i32 %265, %258
  %267 = icmp eq i32 %266, 0
  br i1 %267, label %272, label %268

268:
  %269 = getelementptr inbounds %struct.Tape, ptr %2, i64 %262, i32 1
  %270 = load i64, ptr %269, align 8
  %271 = tail call i64 @llvm.smax.i64(i64 %270, i64 %263)
  br label %272

272:
  %273 = phi i64 [ %263, %261 ], [ %271, %268 ]
  %274 = add nuw nsw i64 %262, 1
  %275 = icmp eq i64 %274, 8
  br i1 %275, label %259, label %261

276:
  %277 = phi i64 [ %278, %279 ], [ %273, %259 ]
  %278 = add nsw i64 %277, -1
  br label %283

279:
  %280 = load ptr, ptr %63, align 8
  %281 = tail call zeroext i8 %280(ptr noundef %97, i8 noundef zeroext %317, i64 noundef 0)
  %282 = icmp sgt i64 %277, 1
  br i1 %282, label %276, label %320

283:
  %284 = phi i64 [ 0, %276 ], [ %318, %316 ]
  %285 = phi i8 [ 0, %276 ], [ %317, %316 ]
  %286 = trunc i64 %284 to i32
  %287 = shl nuw i32 1, %286
  %288 = and i32 %287, %258
  %289 = icmp eq i32 %288, 0
  br i1 %289, label %316, label %290

290:
  %291 = getelementptr inbounds %struct.Tape, ptr %2, i64 %284, i32 1
  %292 = load i64, ptr %291, align 8
  %293 = icmp sgt i64 %277, %292
  br i1 %293, label %316, label %294

294:
  %295 = getelementptr inbounds %struct.Tape, ptr %2, i64 %284
  %296 = trunc i32 %287 to i8
  %297 = or i8 %285, %296
  %298 = load ptr, ptr %295, align 8
  %299 = load i64, ptr %53, align 8
  %300 = mul nsw i64 %299, %278
  %301 = getelementptr inbounds double, ptr %298, i64 %300
  %302 = icmp sgt i64 %299, 0
  br i1 %302, label %303, label %316

303:
  %304 = phi i64 [ %313, %303 ], [ 0, %294 ]
  %305 = getelementptr inbounds double, ptr %301, i64 %304
  %306 = load double, ptr %305, align 8
  %307 = load ptr, ptr %54, align 8
  %308 = getelementptr inbounds i64, ptr %307, i64 %304
  %309 = load i64, ptr %308, align 8
  %310 = shl nsw i64 %309, 3
  %311 = add nsw i64 %310, %284
  %312 = getelementptr inbounds double, ptr %97, i64 %311
  store double %306, ptr %312, align 8
  %313 = add nuw nsw i64 %304, 1
  %314 = load i64, ptr %53, align 8
  %315 = icmp slt i64 %313, %314
  br i1 %315, label %303, label %316

316:
  %317 = phi i8 [ %285, %290 ], [ %285, %283 ], [ %297, %294 ], [ %297, %303 ]
  %318 = add nuw nsw i64 %284, 1
  %319 = icmp eq i64 %318, 8
  br i1 %319, label %279, label %283

320:
  %321 = load ptr, ptr %64, align 8
  %322 = tail call zeroext i8 %321(ptr noundef %97, i8 noundef zeroext %72, i64 noundef 0)
  br label %323

323:
  %324 = phi i32 [ 0, %320 ], [ %330, %329 ]
  %325 = shl nuw i32 1, %324
  %326 = and i32 %325, %258
  %327 = icmp eq i32 %326, 0
  br i1 %327, label %329, label %328

328:
  call fastcc void @give_lane(ptr noundef nonnull %0, ptr noundef nonnull %49, ptr noundef nonnull %3, i32 noundef %324)
  br label %329

329:
  %330 = add nuw nsw i32 %324, 1
  %331 = icmp eq i32 %330, 8
  br i1 %331, label %93, label %323

332:
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(64) %41, i8 -1, i64 64, i1 false)
  br label %333

333:
  %334 = phi i64 [ 0, %332 ], [ %337, %333 ]
  %335 = getelementptr inbounds [8 x %struct.Tape], ptr %2, i64 0, i64 %334
  %336 = load ptr, ptr %335, align 8
  tail call void @free(ptr noundef %336)
  %337 = add nuw nsw i64 %334, 1
  %338 = icmp eq i64 %337, 8
  br i1 %338, label %339, label %333

339:
  call void @llvm.lifetime.end.p0(i64 192, ptr nonnull %2)
  br label %663

340:
  %341 = load i64, ptr %35, align 8
  %342 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 8
  %343 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 1
  %344 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 3
  %345 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 11
  %346 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 12
  %347 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 13
  %348 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 14
  %349 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 7
  %350 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 2
  %351 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 6
  %352 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 9
  %353 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 15
  %354 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 10
  %355 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 16
  br label %356

356:
  %357 = phi i8 [ 0, %340 ], [ %662, %661 ]
  br label %360

358:
  %359 = icmp eq i8 %388, 0
  br i1 %359, label %402, label %398

360:
  %361 = phi i64 [ 0, %356 ], [ %396, %387 ]
  %362 = phi i8 [ %357, %356 ], [ %388, %387 ]
  %363 = phi i8 [ 0, %356 ], [ %395, %387 ]
  %364 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 1, i64 %361
  %365 = load i64, ptr %364, align 8
  %366 = icmp slt i64 %365, 0
  br i1 %366, label %367, label %387

367:
  %368 = trunc i64 %361 to i32
  %369 = call fastcc i32 @take_lane(ptr noundef nonnull %0, i64 noundef %44, ptr noundef nonnull %3, i32 noundef %368)
  %370 = icmp eq i32 %369, 0
  br i1 %370, label %387, label %371

371:
  %372 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %361
  store i64 0, ptr %372, align 8
  %373 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 4, i64 %361
  store i64 0, ptr %373, align 8
  %374 = load i64, ptr %342, align 8
  %375 = icmp sgt i64 %374, -1
  br i1 %375, label %376, label %383

376:
  %377 = load ptr, ptr %3, align 8
  %378 = shl nsw i64 %374, 3
  %379 = add nsw i64 %378, %361
  %380 = getelementptr inbounds double, ptr %377, i64 %379
  %381 = load double, ptr %380, align 8
  %382 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 3, i64 %361
  store double %381, ptr %382, align 8
  br label %383

383:
  %384 = shl nuw i32 1, %368
  %385 = trunc i32 %384 to i8
  %386 = or i8 %362, %385
  br label %387

387:
  %388 = phi i8 [ %386, %383 ], [ %362, %367 ], [ %362, %360 ]
  %389 = load i64, ptr %364, align 8
  %390 = trunc i64 %361 to i32
  %391 = shl nuw i32 1, %390
  %392 = trunc i32 %391 to i8
  %393 = icmp slt i64 %389, 0
  %394 = select i1 %393, i8 0, i8 %392
  %395 = or i8 %394, %363
  %396 = add nuw nsw i64 %361, 1
  %397 = icmp eq i64 %396, 8
  br i1 %397, label %358, label %360

398:
  %399 = load ptr, ptr %49, align 8
  %400 = load ptr, ptr %3, align 8
  %401 = tail call zeroext i8 %399(ptr noundef %400, i8 noundef zeroext %388, i64 noundef %341)
  br label %402

402:
  %403 = icmp eq i8 %395, 0
  br i1 %403, label %661, label %404

404:
  %405 = zext i8 %395 to i32
  %406 = load ptr, ptr %3, align 8
  br label %407

407:
  %408 = load ptr, ptr %343, align 8
  %409 = tail call zeroext i8 %408(ptr noundef %406, i8 noundef zeroext %395, i64 noundef %341)
  %410 = xor i8 %409, -1
  %411 = and i8 %395, %410
  %412 = load ptr, ptr %344, align 8
  %413 = icmp eq ptr %412, null
  br i1 %413, label %602, label %414

414:
  %415 = load i64, ptr %345, align 8
  %416 = shl nsw i64 %415, 3
  %417 = getelementptr inbounds double, ptr %406, i64 %416
  %418 = load i64, ptr %346, align 8
  %419 = shl nsw i64 %418, 3
  %420 = getelementptr inbounds double, ptr %406, i64 %419
  %421 = zext i8 %411 to i32
  br label %424

422:
  %423 = icmp eq i8 %497, 0
  br i1 %423, label %602, label %503

424:
  %425 = phi i64 [ 0, %414 ], [ %501, %500 ]
  %426 = phi i8 [ 0, %414 ], [ %502, %500 ]
  %427 = trunc i64 %425 to i32
  %428 = shl nuw i32 1, %427
  %429 = and i32 %428, %405
  %430 = icmp eq i32 %429, 0
  br i1 %430, label %496, label %431

431:
  %432 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %425
  %433 = load i64, ptr %432, align 8
  %434 = load ptr, ptr %36, align 8
  %435 = icmp eq ptr %434, null
  br i1 %435, label %448, label %436

436:
  %437 = icmp eq i64 %433, 0
  br i1 %437, label %483, label %438

438:
  %439 = load i64, ptr %345, align 8
  %440 = shl nsw i64 %439, 3
  %441 = add nsw i64 %440, %425
  %442 = getelementptr inbounds double, ptr %406, i64 %441
  %443 = load double, ptr %442, align 8
  %444 = getelementptr inbounds %struct.Course, ptr %434, i64 0, i32 3
  %445 = load double, ptr %444, align 8
  %446 = fcmp ogt double %443, %445
  %447 = select i1 %446, double %443, double 0x7FF0000000000000
  br label %483

448:
  %449 = load i64, ptr %37, align 8
  %450 = icmp eq i64 %433, %449
  br i1 %450, label %483, label %451

451:
  %452 = load ptr, ptr %38, align 8
  %453 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 1, i64 %425
  %454 = load i64, ptr %453, align 8
  %455 = load i64, ptr %39, align 8
  %456 = icmp eq i64 %455, 1
  %457 = load ptr, ptr %452, align 8
  br i1 %456, label %458, label %463

458:
  %459 = getelementptr inbounds %struct.Operand, ptr %452, i64 0, i32 1
  %460 = load i64, ptr %459, align 8
  %461 = mul nsw i64 %460, %454
  %462 = getelementptr inbounds double, ptr %457, i64 %461
  br label %479

463:
  %464 = icmp sgt i64 %455, 0
  br i1 %464, label %465, label %479

465:
  %466 = phi i64 [ %469, %465 ], [ %455, %463 ]
  %467 = phi ptr [ %476, %465 ], [ %457, %463 ]
  %468 = phi i64 [ %477, %465 ], [ %454, %463 ]
  %469 = add nsw i64 %466, -1
  %470 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %469
  %471 = load i64, ptr %470, align 8
  %472 = srem i64 %468, %471
  %473 = getelementptr inbounds %struct.Operand, ptr %452, i64 0, i32 1, i64 %469
  %474 = load i64, ptr %473, align 8
  %475 = mul nsw i64 %474, %472
  %476 = getelementptr inbounds double, ptr %467, i64 %475
  %477 = sdiv i64 %468, %471
  %478 = icmp sgt i64 %466, 1
  br i1 %478, label %465, label %479

479:
  %480 = phi ptr [ %462, %458 ], [ %457, %463 ], [ %476, %465 ]
  %481 = getelementptr inbounds double, ptr %480, i64 %433
  %482 = load double, ptr %481, align 8
  br label %483

483:
  %484 = phi double [ %482, %479 ], [ %447, %438 ], [ 0.000000e+00, %436 ], [ 0x7FF0000000000000, %448 ]
  %485 = getelementptr inbounds double, ptr %420, i64 %425
  store double %484, ptr %485, align 8
  %486 = getelementptr inbounds double, ptr %417, i64 %425
  %487 = load double, ptr %486, align 8
  %488 = and i32 %428, %421
  %489 = icmp eq i32 %488, 0
  %490 = select i1 %489, double 1.000000e+00, double 0x3FF000010C6F7A0B
  %491 = fmul double %490, %487
  %492 = fcmp ugt double %484, %491
  %493 = trunc i32 %428 to i8
  %494 = select i1 %492, i8 0, i8 %493
  %495 = or i8 %494, %426
  br label %496

496:
  %497 = phi i8 [ %495, %483 ], [ %426, %424 ]
  %498 = add nuw nsw i64 %425, 1
  %499 = icmp eq i64 %498, 8
  br i1 %499, label %422, label %500

500:
  %501 = phi i64 [ %498, %496 ], [ 0, %599 ]
  %502 = phi i8 [ %497, %496 ], [ 0, %599 ]
  br label %424

503:
  %504 = load ptr, ptr %344, align 8
  %505 = load i64, ptr %35, align 8
  %506 = tail call zeroext i8 %504(ptr noundef %406, i8 noundef zeroext %497, i64 noundef %505)
  %507 = zext i8 %497 to i32
  br label %508

508:
  %509 = phi i64 [ 0, %503 ], [ %600, %599 ]
  %510 = trunc i64 %509 to i32
  %511 = shl nuw i32 1, %510
  %512 = and i32 %511, %507
  %513 = icmp eq i32 %512, 0
  br i1 %513, label %599, label %514

514:
  %515 = load i64, ptr %347, align 8
  %516 = shl nsw i64 %515, 3
  %517 = getelementptr inbounds double, ptr %406, i64 %516
  %518 = getelementptr inbounds double, ptr %517, i64 %509
  %519 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %509
  %520 = load i64, ptr %519, align 8
  %521 = load ptr, ptr %36, align 8
  %522 = icmp eq ptr %521, null
  br i1 %522, label %551, label %523

523:
  %524 = load i64, ptr %346, align 8
  %525 = shl nsw i64 %524, 3
  %526 = add nsw i64 %525, %509
  %527 = getelementptr inbounds double, ptr %406, i64 %526
  %528 = load double, ptr %527, align 8
  %529 = getelementptr inbounds %struct.Course, ptr %521, i64 0, i32 3
  store double %528, ptr %529, align 8
  %530 = add nsw i64 %520, 1
  %531 = getelementptr inbounds %struct.Course, ptr %521, i64 0, i32 2
  store i64 %530, ptr %531, align 8
  %532 = getelementptr inbounds %struct.Course, ptr %521, i64 0, i32 1
  %533 = load i64, ptr %532, align 8
  %534 = icmp slt i64 %520, %533
  br i1 %534, label %535, label %597

535:
  %536 = load i64, ptr %348, align 8
  %537 = icmp sgt i64 %536, 0
  br i1 %537, label %538, label %597

538:
  %539 = phi i64 [ %548, %538 ], [ 0, %535 ]
  %540 = shl nsw i64 %539, 3
  %541 = getelementptr inbounds double, ptr %518, i64 %540
  %542 = load double, ptr %541, align 8
  %543 = load ptr, ptr %521, align 8
  %544 = load i64, ptr %532, align 8
  %545 = mul nsw i64 %544, %539
  %546 = add nsw i64 %545, %520
  %547 = getelementptr inbounds double, ptr %543, i64 %546
  store double %542, ptr %547, align 8
  %548 = add nuw nsw i64 %539, 1
  %549 = load i64, ptr %348, align 8
  %550 = icmp slt i64 %548, %549
  br i1 %550, label %538, label %597

551:
  %552 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 1, i64 %509
  %553 = load i64, ptr %552, align 8
  %554 = load i64, ptr %37, align 8
  %555 = mul nsw i64 %554, %553
  %556 = add nsw i64 %555, %520
  %557 = load ptr, ptr %40, align 8
  %558 = load i64, ptr %349, align 8
  %559 = getelementptr inbounds ptr, ptr %557, i64 %558
  %560 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 2, i64 %509
  %561 = load i64, ptr %560, align 8
  %562 = load i64, ptr %348, align 8
  %563 = load ptr, ptr %0, align 8
  %564 = getelementptr inbounds %struct.Operation, ptr %563, i64 0, i32 6
  %565 = load i64, ptr %564, align 8
  %566 = add nsw i64 %565, 1
  %567 = sdiv i64 %562, %566
  %568 = sub nsw i64 %565, %561
  %569 = load i64, ptr %35, align 8
  %570 = tail call i64 @llvm.smin.i64(i64 %568, i64 %569)
  %571 = add nsw i64 %570, 1
  %572 = mul nsw i64 %571, %567
  %573 = icmp sgt i64 %572, 0
  br i1 %573, label %574, label %597

574:
  %575 = mul nsw i64 %567, %561
  br label %576

576:
  %577 = phi i64 [ 0, %574 ], [ %587, %576 ]
  %578 = shl nsw i64 %577, 3
  %579 = getelementptr inbounds double, ptr %518, i64 %578
  %580 = load double, ptr %579, align 8
  %581 = icmp slt i64 %577, %567
  %582 = select i1 %581, i64 0, i64 %575
  %583 = add nsw i64 %582, %577
  %584 = getelementptr inbounds ptr, ptr %559, i64 %583
  %585 = load ptr, ptr %584, align 8
  %586 = getelementptr inbounds double, ptr %585, i64 %556
  store double %580, ptr %586, align 8
  %587 = add nuw nsw i64 %577, 1
  %588 = load ptr, ptr %0, align 8
  %589 = getelementptr inbounds %struct.Operation, ptr %588, i64 0, i32 6
  %590 = load i64, ptr %589, align 8
  %591 = sub nsw i64 %590, %561
  %592 = load i64, ptr %35, align 8
  %593 = tail call i64 @llvm.smin.i64(i64 %591, i64 %592)
  %594 = add nsw i64 %593, 1
  %595 = mul nsw i64 %594, %567
  %596 = icmp slt i64 %587, %595
  br i1 %596, label %576, label %597

597:
  %598 = add nsw i64 %520, 1
  store i64 %598, ptr %519, align 8
  br label %599

599:
  %600 = add nuw nsw i64 %509, 1
  %601 = icmp eq i64 %600, 8
  br i1 %601, label %500, label %508

602:
  %603 = icmp eq i8 %411, 0
  br i1 %603, label %407, label %604

604:
  %605 = load ptr, ptr %350, align 8
  %606 = tail call zeroext i8 %605(ptr noundef %406, i8 noundef zeroext %411, i64 noundef %341)
  %607 = zext i8 %411 to i32
  br label %608

608:
  %609 = phi i64 [ 0, %604 ], [ %659, %657 ]
  %610 = phi i8 [ 0, %604 ], [ %658, %657 ]
  %611 = trunc i64 %609 to i32
  %612 = shl nuw i32 1, %611
  %613 = and i32 %612, %607
  %614 = icmp eq i32 %613, 0
  br i1 %614, label %657, label %615

615:
  %616 = load i64, ptr %342, align 8
  %617 = icmp slt i64 %616, 0
  br i1 %617, label %655, label %618

618:
  %619 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 4, i64 %609
  %620 = load i64, ptr %619, align 8
  %621 = icmp eq i64 %620, 7
  br i1 %621, label %655, label %622

622:
  %623 = load i64, ptr %351, align 8
  %624 = shl nsw i64 %623, 3
  %625 = getelementptr inbounds double, ptr %406, i64 %624
  %626 = getelementptr inbounds double, ptr %625, i64 %609
  %627 = load i64, ptr %352, align 8
  %628 = shl nsw i64 %627, 3
  %629 = getelementptr inbounds double, ptr %626, i64 %628
  %630 = load double, ptr %629, align 8
  %631 = load double, ptr %353, align 8
  %632 = fcmp une double %630, %631
  br i1 %632, label %655, label %633

633:
  %634 = load i64, ptr %354, align 8
  %635 = shl nsw i64 %634, 3
  %636 = getelementptr inbounds double, ptr %626, i64 %635
  %637 = load double, ptr %636, align 8
  %638 = load double, ptr %355, align 8
  %639 = fcmp oge double %637, %638
  %640 = icmp sgt i64 %620, 0
  %641 = select i1 %639, i1 %640, i1 false
  br i1 %641, label %655, label %642

642:
  %643 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 3, i64 %609
  %644 = load double, ptr %643, align 8
  %645 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 17, i64 %620
  %646 = load double, ptr %645, align 8
  %647 = fmul double %644, %646
  %648 = shl nsw i64 %616, 3
  %649 = add nsw i64 %648, %609
  %650 = getelementptr inbounds double, ptr %406, i64 %649
  store double %647, ptr %650, align 8
  %651 = add nsw i64 %620, 1
  store i64 %651, ptr %619, align 8
  %652 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %609
  store i64 0, ptr %652, align 8
  %653 = trunc i32 %612 to i8
  %654 = or i8 %610, %653
  br label %657

655:
  call fastcc void @give_lane(ptr noundef nonnull %0, ptr noundef nonnull %49, ptr noundef nonnull %3, i32 noundef %611)
  %656 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 1, i64 %609
  store i64 -1, ptr %656, align 8
  br label %657

657:
  %658 = phi i8 [ %654, %642 ], [ %610, %655 ], [ %610, %608 ]
  %659 = add nuw nsw i64 %609, 1
  %660 = icmp eq i64 %659, 8
  br i1 %660, label %661, label %608

661:
  %662 = phi i8 [ %357, %402 ], [ %658, %657 ]
  br i1 %403, label %663, label %356

663:
  %664 = add nuw nsw i64 %44, 1
  %665 = load i64, ptr %4, align 8
  %666 = icmp slt i64 %664, %665
  br i1 %666, label %43, label %42

667:
  ret ptr null
}

define internal i32 @work_on_windows(ptr nocapture noundef %0) {
  %2 = tail call ptr @work(ptr noundef %0)
  ret i32 0
}

define internal fastcc i32 @take_lane(ptr nocapture noundef %0, i64 noundef %1, ptr nocapture noundef %2, i32 noundef %3) unnamed_addr {
  %5 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 19, i64 %1
  %6 = atomicrmw add ptr %5, i64 1 monotonic, align 8
  %7 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 20, i64 %1
  %8 = load i64, ptr %7, align 8
  %9 = icmp slt i64 %6, %8
  br i1 %9, label %10, label %154

10:
  %11 = load ptr, ptr %0, align 8
  %12 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 18
  %13 = load ptr, ptr %12, align 8
  %14 = getelementptr inbounds %struct.Turn, ptr %13, i64 %6, i32 1
  %15 = load i64, ptr %14, align 8
  %16 = getelementptr inbounds %struct.Turn, ptr %13, i64 %6, i32 2
  %17 = load i64, ptr %16, align 8
  %18 = getelementptr inbounds %struct.Operation, ptr %11, i64 0, i32 5
  %19 = load i64, ptr %18, align 8
  %20 = icmp sgt i64 %19, 0
  br i1 %20, label %21, label %24

21:
  %22 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 8
  %23 = sext i32 %3 to i64
  br label %32

24:
  %25 = phi i64 [ %19, %10 ], [ %43, %32 ]
  %26 = getelementptr inbounds %struct.Operation, ptr %11, i64 0, i32 5
  %27 = getelementptr inbounds %struct.Operation, ptr %11, i64 0, i32 1, i64 %1, i32 5
  %28 = load i64, ptr %27, align 8
  %29 = icmp slt i64 %25, %28
  br i1 %29, label %30, label %45

30:
  %31 = sext i32 %3 to i64
  br label %54

32:
  %33 = phi i64 [ 0, %21 ], [ %42, %32 ]
  %34 = load ptr, ptr %22, align 8
  %35 = load ptr, ptr %34, align 8
  %36 = getelementptr inbounds double, ptr %35, i64 %33
  %37 = load double, ptr %36, align 8
  %38 = load ptr, ptr %2, align 8
  %39 = shl nsw i64 %33, 3
  %40 = add nsw i64 %39, %23
  %41 = getelementptr inbounds double, ptr %38, i64 %40
  store double %37, ptr %41, align 8
  %42 = add nuw nsw i64 %33, 1
  %43 = load i64, ptr %18, align 8
  %44 = icmp slt i64 %42, %43
  br i1 %44, label %32, label %24

45:
  %46 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 7
  %47 = load i64, ptr %46, align 8
  %48 = icmp sgt i64 %47, 0
  br i1 %48, label %49, label %63

49:
  %50 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 9
  %51 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 10
  %52 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 1
  %53 = sext i32 %3 to i64
  br label %76

54:
  %55 = phi i64 [ %25, %30 ], [ %60, %54 ]
  %56 = load ptr, ptr %2, align 8
  %57 = shl nsw i64 %55, 3
  %58 = add nsw i64 %57, %31
  %59 = getelementptr inbounds double, ptr %56, i64 %58
  store double 0.000000e+00, ptr %59, align 8
  %60 = add nsw i64 %55, 1
  %61 = load i64, ptr %27, align 8
  %62 = icmp slt i64 %60, %61
  br i1 %62, label %54, label %45

63:
  %64 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 5
  %65 = load ptr, ptr %0, align 8
  %66 = getelementptr inbounds %struct.Operation, ptr %65, i64 0, i32 6
  %67 = load i64, ptr %66, align 8
  %68 = sub nsw i64 %67, %17
  %69 = load i64, ptr %64, align 8
  %70 = tail call i64 @llvm.smin.i64(i64 %68, i64 %69)
  %71 = icmp sgt i64 %70, 0
  br i1 %71, label %72, label %119

72:
  %73 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 13
  %74 = getelementptr inbounds %struct.Operation, ptr %11, i64 0, i32 6
  %75 = sext i32 %3 to i64
  br label %123

76:
  %77 = phi i64 [ 0, %49 ], [ %116, %109 ]
  %78 = load ptr, ptr %50, align 8
  %79 = load ptr, ptr %78, align 8
  %80 = getelementptr inbounds double, ptr %79, i64 %77
  %81 = load double, ptr %80, align 8
  %82 = fptosi double %81 to i64
  %83 = load ptr, ptr %51, align 8
  %84 = getelementptr inbounds %struct.Operand, ptr %83, i64 %77
  %85 = load i64, ptr %52, align 8
  %86 = icmp eq i64 %85, 1
  %87 = load ptr, ptr %84, align 8
  br i1 %86, label %88, label %93

88:
  %89 = getelementptr inbounds %struct.Operand, ptr %83, i64 %77, i32 1
  %90 = load i64, ptr %89, align 8
  %91 = mul nsw i64 %90, %15
  %92 = getelementptr inbounds double, ptr %87, i64 %91
  br label %109

93:
  %94 = icmp sgt i64 %85, 0
  br i1 %94, label %95, label %109

95:
  %96 = phi i64 [ %99, %95 ], [ %85, %93 ]
  %97 = phi ptr [ %106, %95 ], [ %87, %93 ]
  %98 = phi i64 [ %107, %95 ], [ %15, %93 ]
  %99 = add nsw i64 %96, -1
  %100 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %99
  %101 = load i64, ptr %100, align 8
  %102 = srem i64 %98, %101
  %103 = getelementptr inbounds %struct.Operand, ptr %83, i64 %77, i32 1, i64 %99
  %104 = load i64, ptr %103, align 8
  %105 = mul nsw i64 %104, %102
  %106 = getelementptr inbounds double, ptr %97, i64 %105
  %107 = sdiv i64 %98, %101
  %108 = icmp sgt i64 %96, 1
  br i1 %108, label %95, label %109

109:
  %110 = phi ptr [ %92, %88 ], [ %87, %93 ], [ %106, %95 ]
  %111 = load double, ptr %110, align 8
  %112 = load ptr, ptr %2, align 8
  %113 = shl nsw i64 %82, 3
  %114 = add nsw i64 %113, %53
  %115 = getelementptr inbounds double, ptr %112, i64 %114
  store double %111, ptr %115, align 8
  %116 = add nuw nsw i64 %77, 1
  %117 = load i64, ptr %46, align 8
  %118 = icmp slt i64 %116, %117
  br i1 %118, label %76, label %63

119:
  %120 = sext i32 %3 to i64
  %121 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %120
  store i64 %15, ptr %121, align 8
  %122 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 2, i64 %120
  store i64 %17, ptr %122, align 8
  br label %154

123:
  %124 = phi i64 [ 0, %72 ], [ %146, %145 ]
  %125 = load ptr, ptr %73, align 8
  %126 = load ptr, ptr %125, align 8
  %127 = add nsw i64 %124, %17
  %128 = getelementptr inbounds double, ptr %126, i64 %127
  %129 = load double, ptr %128, align 8
  %130 = fptosi double %129 to i64
  %131 = icmp sgt i64 %130, -1
  br i1 %131, label %132, label %145

132:
  %133 = load i64, ptr %27, align 8
  %134 = load i64, ptr %26, align 8
  %135 = sub nsw i64 %133, %134
  %136 = load i64, ptr %74, align 8
  %137 = sdiv i64 %135, %136
  %138 = load ptr, ptr %2, align 8
  %139 = mul nsw i64 %137, %124
  %140 = add i64 %134, %130
  %141 = add i64 %140, %139
  %142 = shl nsw i64 %141, 3
  %143 = add nsw i64 %142, %75
  %144 = getelementptr inbounds double, ptr %138, i64 %143
  store double 1.000000e+00, ptr %144, align 8
  br label %145

145:
  %146 = add nuw nsw i64 %124, 1
  %147 = load ptr, ptr %0, align 8
  %148 = getelementptr inbounds %struct.Operation, ptr %147, i64 0, i32 6
  %149 = load i64, ptr %148, align 8
  %150 = sub nsw i64 %149, %17
  %151 = load i64, ptr %64, align 8
  %152 = tail call i64 @llvm.smin.i64(i64 %150, i64 %151)
  %153 = icmp slt i64 %146, %152
  br i1 %153, label %123, label %119

154:
  %155 = phi i32 [ 1, %119 ], [ 0, %4 ]
  ret i32 %155
}

define internal fastcc void @give_lane(ptr nocapture noundef readonly %0, ptr nocapture noundef readonly %1, ptr nocapture noundef readonly %2, i32 noundef %3) unnamed_addr {
  %5 = load ptr, ptr %2, align 8
  %6 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 6
  %7 = load i64, ptr %6, align 8
  %8 = shl nsw i64 %7, 3
  %9 = getelementptr inbounds double, ptr %5, i64 %8
  %10 = sext i32 %3 to i64
  %11 = getelementptr inbounds double, ptr %9, i64 %10
  %12 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %10
  %13 = load i64, ptr %12, align 8
  %14 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 2, i64 %10
  %15 = load i64, ptr %14, align 8
  %16 = load ptr, ptr %0, align 8
  %17 = getelementptr inbounds %struct.Operation, ptr %16, i64 0, i32 6
  %18 = load i64, ptr %17, align 8
  %19 = sub nsw i64 %18, %15
  %20 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 5
  %21 = load i64, ptr %20, align 8
  %22 = tail call i64 @llvm.smin.i64(i64 %19, i64 %21)
  %23 = add nsw i64 %22, 1
  %24 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 7
  %25 = load i64, ptr %24, align 8
  %26 = add nsw i64 %18, 1
  %27 = sdiv i64 %25, %26
  %28 = mul nsw i64 %27, %23
  %29 = icmp sgt i64 %28, 0
  br i1 %29, label %30, label %33

30:
  %31 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 15
  %32 = mul nsw i64 %27, %15
  br label %37

33:
  %34 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 17
  %35 = load ptr, ptr %34, align 8
  %36 = icmp eq ptr %35, null
  br i1 %36, label %51, label %92

37:
  %38 = phi i64 [ 0, %30 ], [ %49, %37 ]
  %39 = shl nsw i64 %38, 3
  %40 = getelementptr inbounds double, ptr %11, i64 %39
  %41 = load double, ptr %40, align 8
  %42 = load ptr, ptr %31, align 8
  %43 = icmp slt i64 %38, %27
  %44 = select i1 %43, i64 0, i64 %32
  %45 = add nsw i64 %44, %38
  %46 = getelementptr inbounds ptr, ptr %42, i64 %45
  %47 = load ptr, ptr %46, align 8
  %48 = getelementptr inbounds double, ptr %47, i64 %13
  store double %41, ptr %48, align 8
  %49 = add nuw nsw i64 %38, 1
  %50 = icmp eq i64 %49, %28
  br i1 %50, label %33, label %37

51:
  %52 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 15
  %53 = load ptr, ptr %52, align 8
  %54 = load i64, ptr %24, align 8
  %55 = getelementptr inbounds ptr, ptr %53, i64 %54
  %56 = getelementptr inbounds %struct.Program, ptr %1, i64 0, i32 14
  %57 = load i64, ptr %56, align 8
  %58 = load ptr, ptr %0, align 8
  %59 = getelementptr inbounds %struct.Operation, ptr %58, i64 0, i32 6
  %60 = load i64, ptr %59, align 8
  %61 = add nsw i64 %60, 1
  %62 = sdiv i64 %57, %61
  %63 = mul nsw i64 %62, %23
  %64 = icmp sgt i64 %63, 0
  br i1 %64, label %65, label %92

65:
  %66 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 5, i64 %10
  %67 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 16
  %68 = mul nsw i64 %62, %15
  br label %69

69:
  %70 = phi i64 [ 0, %65 ], [ %80, %79 ]
  %71 = load i64, ptr %66, align 8
  %72 = load i64, ptr %67, align 8
  %73 = icmp slt i64 %71, %72
  br i1 %73, label %74, label %79

74:
  %75 = icmp slt i64 %70, %62
  %76 = select i1 %75, i64 0, i64 %68
  %77 = add nsw i64 %76, %70
  %78 = getelementptr inbounds ptr, ptr %55, i64 %77
  br label %82

79:
  %80 = add nuw nsw i64 %70, 1
  %81 = icmp eq i64 %80, %63
  br i1 %81, label %92, label %69

82:
  %83 = phi i64 [ %72, %74 ], [ %90, %82 ]
  %84 = phi i64 [ %71, %74 ], [ %89, %82 ]
  %85 = load ptr, ptr %78, align 8
  %86 = mul nsw i64 %83, %13
  %87 = add nsw i64 %86, %84
  %88 = getelementptr inbounds double, ptr %85, i64 %87
  store double 0x7FF8000000000000, ptr %88, align 8
  %89 = add nsw i64 %84, 1
  %90 = load i64, ptr %67, align 8
  %91 = icmp slt i64 %89, %90
  br i1 %91, label %82, label %79

92:
  ret void
}

declare i64 @llvm.smin.i64(i64, i64)

declare i64 @llvm.smax.i64(i64, i64)

