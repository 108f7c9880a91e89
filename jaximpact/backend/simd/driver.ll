; Made from driver.c by 'make driver'; sha256 80606e23efd8670a5b1e255c07cbe77bcfcdbd32de7086a7c3a78edd4dda0027

%struct.Operation = type { i64, [32 x %struct.Program], [32 x i64], ptr, ptr, i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr }
%struct.Program = type { ptr, ptr, ptr, ptr, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, double, double, [7 x double], ptr, ptr, ptr, ptr, i64, i64 }
%struct.Operand = type { ptr, [24 x i64] }
%struct.Job = type { ptr, i64, [24 x i64], i64, i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, i64, ptr, ptr, [32 x i64], [32 x i64], i32, i32 }
%struct.Rows = type { ptr, i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr }
%struct.Turn = type { double, i64, i64 }
%struct.anon = type { i64, ptr, ptr, i32 }
%struct.Way = type { ptr, i64, i64 }
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
  %2 = alloca [8 x %struct.Way], align 16
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
  br label %651

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
  br label %651

43:
  %44 = phi i64 [ 0, %33 ], [ %648, %647 ]
  %45 = getelementptr inbounds %struct.Operation, ptr %4, i64 0, i32 1, i64 %44, i32 19
  %46 = load ptr, ptr %45, align 8
  %47 = icmp eq ptr %46, null
  %48 = load ptr, ptr %0, align 8
  %49 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44
  br i1 %47, label %326, label %50

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
  br i1 %73, label %318, label %96

74:
  %75 = shl nuw i32 1, %68
  %76 = trunc i32 %75 to i8
  %77 = or i8 %67, %76
  %78 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %66
  store i64 0, ptr %78, align 8
  %79 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 4, i64 %66
  store i64 0, ptr %79, align 8
  %80 = getelementptr inbounds [8 x %struct.Way], ptr %2, i64 0, i64 %66, i32 1
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
  %94 = phi i64 [ %91, %90 ], [ 0, %315 ]
  %95 = phi i8 [ %77, %90 ], [ 0, %315 ]
  br label %65

96:
  %97 = load ptr, ptr %3, align 8
  %98 = load i64, ptr %52, align 8
  %99 = shl nsw i64 %98, 3
  %100 = getelementptr inbounds double, ptr %97, i64 %99
  br label %101

101:
  %102 = phi i8 [ %72, %96 ], [ %238, %236 ]
  %103 = phi i8 [ %72, %96 ], [ %237, %236 ]
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
  %111 = phi i64 [ 0, %108 ], [ %155, %154 ]
  %112 = trunc i64 %111 to i32
  %113 = shl nuw i32 1, %112
  %114 = and i32 %113, %109
  %115 = icmp eq i32 %114, 0
  br i1 %115, label %154, label %116

116:
  %117 = getelementptr inbounds %struct.Way, ptr %2, i64 %111
  %118 = getelementptr inbounds %struct.Way, ptr %2, i64 %111, i32 1
  %119 = load i64, ptr %118, align 8
  %120 = getelementptr inbounds %struct.Way, ptr %2, i64 %111, i32 2
  %121 = load i64, ptr %120, align 8
  %122 = icmp eq i64 %119, %121
  br i1 %122, label %123, label %134

123:
  %124 = icmp eq i64 %121, 0
  %125 = shl nsw i64 %121, 1
  %126 = select i1 %124, i64 64, i64 %125
  %127 = load ptr, ptr %117, align 8
  %128 = load i64, ptr %53, align 8
  %129 = shl i64 %126, 3
  %130 = mul i64 %129, %128
  %131 = tail call ptr @realloc(ptr noundef %127, i64 noundef %130)
  %132 = icmp eq ptr %131, null
  br i1 %132, label %240, label %133

133:
  store ptr %131, ptr %117, align 8
  store i64 %126, ptr %120, align 8
  br label %134

134:
  %135 = load ptr, ptr %117, align 8
  %136 = load i64, ptr %53, align 8
  %137 = load i64, ptr %118, align 8
  %138 = mul nsw i64 %137, %136
  %139 = getelementptr inbounds double, ptr %135, i64 %138
  %140 = icmp sgt i64 %136, 0
  br i1 %140, label %141, label %154

141:
  %142 = phi i64 [ %151, %141 ], [ 0, %134 ]
  %143 = load ptr, ptr %54, align 8
  %144 = getelementptr inbounds i64, ptr %143, i64 %142
  %145 = load i64, ptr %144, align 8
  %146 = shl nsw i64 %145, 3
  %147 = add nsw i64 %146, %111
  %148 = getelementptr inbounds double, ptr %97, i64 %147
  %149 = load double, ptr %148, align 8
  %150 = getelementptr inbounds double, ptr %139, i64 %142
  store double %149, ptr %150, align 8
  %151 = add nuw nsw i64 %142, 1
  %152 = load i64, ptr %53, align 8
  %153 = icmp slt i64 %151, %152
  br i1 %153, label %141, label %154

154:
  %155 = add nuw nsw i64 %111, 1
  %156 = icmp eq i64 %155, 8
  br i1 %156, label %157, label %110

157:
  %158 = load ptr, ptr %55, align 8
  %159 = tail call zeroext i8 %158(ptr noundef %97, i8 noundef zeroext %103, i64 noundef 0)
  br label %164

160:
  %161 = xor i8 %159, -1
  %162 = and i8 %103, %161
  %163 = icmp eq i8 %162, 0
  br i1 %163, label %236, label %178

164:
  %165 = phi i64 [ 0, %157 ], [ %176, %175 ]
  %166 = trunc i64 %165 to i32
  %167 = shl nuw i32 1, %166
  %168 = and i32 %167, %109
  %169 = icmp eq i32 %168, 0
  br i1 %169, label %175, label %170

170:
  %171 = getelementptr inbounds double, ptr %100, i64 %165
  %172 = load double, ptr %171, align 8
  %173 = fptosi double %172 to i64
  %174 = getelementptr inbounds %struct.Way, ptr %2, i64 %165, i32 1
  store i64 %173, ptr %174, align 8
  br label %175

175:
  %176 = add nuw nsw i64 %165, 1
  %177 = icmp eq i64 %176, 8
  br i1 %177, label %160, label %164

178:
  %179 = load ptr, ptr %56, align 8
  %180 = tail call zeroext i8 %179(ptr noundef %97, i8 noundef zeroext %162, i64 noundef 0)
  %181 = zext i8 %162 to i32
  br label %186

182:
  %183 = xor i8 %162, -1
  %184 = or i8 %233, %183
  %185 = and i8 %184, %103
  br label %236

186:
  %187 = phi i64 [ 0, %178 ], [ %234, %232 ]
  %188 = phi i8 [ 0, %178 ], [ %233, %232 ]
  %189 = trunc i64 %187 to i32
  %190 = shl nuw i32 1, %189
  %191 = and i32 %190, %181
  %192 = icmp eq i32 %191, 0
  br i1 %192, label %232, label %193

193:
  %194 = load i64, ptr %51, align 8
  %195 = icmp slt i64 %194, 0
  br i1 %195, label %232, label %196

196:
  %197 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 4, i64 %187
  %198 = load i64, ptr %197, align 8
  %199 = icmp eq i64 %198, 7
  br i1 %199, label %232, label %200

200:
  %201 = load i64, ptr %57, align 8
  %202 = shl nsw i64 %201, 3
  %203 = getelementptr inbounds double, ptr %97, i64 %202
  %204 = getelementptr inbounds double, ptr %203, i64 %187
  %205 = load i64, ptr %58, align 8
  %206 = shl nsw i64 %205, 3
  %207 = getelementptr inbounds double, ptr %204, i64 %206
  %208 = load double, ptr %207, align 8
  %209 = load double, ptr %59, align 8
  %210 = fcmp une double %208, %209
  br i1 %210, label %232, label %211

211:
  %212 = load i64, ptr %60, align 8
  %213 = shl nsw i64 %212, 3
  %214 = getelementptr inbounds double, ptr %204, i64 %213
  %215 = load double, ptr %214, align 8
  %216 = load double, ptr %61, align 8
  %217 = fcmp ult double %215, %216
  br i1 %217, label %218, label %232

218:
  %219 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 3, i64 %187
  %220 = load double, ptr %219, align 8
  %221 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 17, i64 %198
  %222 = load double, ptr %221, align 8
  %223 = fmul double %220, %222
  %224 = shl nsw i64 %194, 3
  %225 = add nsw i64 %224, %187
  %226 = getelementptr inbounds double, ptr %97, i64 %225
  store double %223, ptr %226, align 8
  %227 = add nsw i64 %198, 1
  store i64 %227, ptr %197, align 8
  %228 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %187
  store i64 0, ptr %228, align 8
  %229 = trunc i32 %190 to i8
  %230 = or i8 %188, %229
  %231 = getelementptr inbounds %struct.Way, ptr %2, i64 %187, i32 1
  store i64 0, ptr %231, align 8
  br label %232

232:
  %233 = phi i8 [ %230, %218 ], [ %188, %186 ], [ %188, %211 ], [ %188, %200 ], [ %188, %196 ], [ %188, %193 ]
  %234 = add nuw nsw i64 %187, 1
  %235 = icmp eq i64 %234, 8
  br i1 %235, label %182, label %186

236:
  %237 = phi i8 [ %185, %182 ], [ %103, %160 ]
  %238 = phi i8 [ %233, %182 ], [ 0, %160 ]
  %239 = icmp eq i8 %237, 0
  br i1 %239, label %241, label %101

240:
  store i32 1, ptr %34, align 8
  br label %318

241:
  %242 = load ptr, ptr %62, align 8
  %243 = tail call zeroext i8 %242(ptr noundef %97, i8 noundef zeroext %72, i64 noundef 0)
  %244 = zext i8 %72 to i32
  br label %247

245:
  %246 = icmp sgt i64 %259, 0
  br i1 %246, label %262, label %306

247:
  %248 = phi i64 [ 0, %241 ], [ %260, %258 ]
  %249 = phi i64 [ 0, %241 ], [ %259, %258 ]
  %250 = trunc i64 %248 to i32
  %251 = shl nuw i32 1, %250
  %252 = and i32 %251, %244
  %253 = icmp eq i32 %252, 0
  br i1 %253, label %258, label %254

254:
  %255 = getelementptr inbounds %struct.Way, ptr %2, i64 %248, i32 1
  %256 = load i64, ptr %255, align 8
  %257 = tail call i64 @llvm.smax.i64(i64 %256, i64 %249)
  br label %258

258:
  %259 = phi i64 [ %249, %247 ], [ %257, %254 ]
  %260 = add nuw nsw i64 %248, 1
  %261 = icmp eq i64 %260, 8
  br i1 %261, label %245, label %247

262:
  %263 = phi i64 [ %264, %265 ], [ %259, %245 ]
  %264 = add nsw i64 %263, -1
  br label %269

265:
  %266 = load ptr, ptr %63, align 8
  %267 = tail call zeroext i8 %266(ptr noundef %97, i8 noundef zeroext %303, i64 noundef 0)
  %268 = icmp sgt i64 %263, 1
  br i1 %268, label %262, label %306

269:
  %270 = phi i64 [ 0, %262 ], [ %304, %302 ]
  %271 = phi i8 [ 0, %262 ], [ %303, %302 ]
  %272 = trunc i64 %270 to i32
  %273 = shl nuw i32 1, %272
  %274 = and i32 %273, %244
  %275 = icmp eq i32 %274, 0
  br i1 %275, label %302, label %276

276:
  %277 = getelementptr inbounds %struct.Way, ptr %2, i64 %270, i32 1
  %278 = load i64, ptr %277, align 8
  %279 = icmp sgt i64 %263, %278
  br i1 %279, label %302, label %280

280:
  %281 = getelementptr inbounds %struct.Way, ptr %2, i64 %270
  %282 = trunc i32 %273 to i8
  %283 = or i8 %271, %282
  %284 = load ptr, ptr %281, align 8
  %285 = load i64, ptr %53, align 8
  %286 = mul nsw i64 %285, %264
  %287 = getelementptr inbounds double, ptr %284, i64 %286
  %288 = icmp sgt i64 %285, 0
  br i1 %288, label %289, label %302

289:
  %290 = phi i64 [ %299, %289 ], [ 0, %280 ]
  %291 = getelementptr inbounds double, ptr %287, i64 %290
  %292 = load double, ptr %291, align 8
  %293 = load ptr, ptr %54, align 8
  %294 = getelementptr inbounds i64, ptr %293, i64 %290
  %295 = load i64, ptr %294, align 8
  %296 = shl nsw i64 %295, 3
  %297 = add nsw i64 %296, %270
  %298 = getelementptr inbounds double, ptr %97, i64 %297
  store double %292, ptr %298, align 8
  %299 = add nuw nsw i64 %290, 1
  %300 = load i64, ptr %53, align 8
  %301 = icmp slt i64 %299, %300
  br i1 %301, label %289, label %302

302:
  %303 = phi i8 [ %271, %276 ], [ %271, %269 ], [ %283, %280 ], [ %283, %289 ]
  %304 = add nuw nsw i64 %270, 1
  %305 = icmp eq i64 %304, 8
  br i1 %305, label %265, label %269

306:
  %307 = load ptr, ptr %64, align 8
  %308 = tail call zeroext i8 %307(ptr noundef %97, i8 noundef zeroext %72, i64 noundef 0)
  br label %309

309:
  %310 = phi i32 [ 0, %306 ], [ %316, %315 ]
  %311 = shl nuw i32 1, %310
  %312 = and i32 %311, %244
  %313 = icmp eq i32 %312, 0
  br i1 %313, label %315, label %314

314:
  call fastcc void @give_lane(ptr noundef nonnull %0, ptr noundef nonnull %49, ptr noundef nonnull %3, i32 noundef %310)
  br label %315

315:
  %316 = add nuw nsw i32 %310, 1
  %317 = icmp eq i32 %316, 8
  br i1 %317, label %93, label %309

318:
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(64) %41, i8 -1, i64 64, i1 false)
  br label %319

319:
  %320 = phi i64 [ 0, %318 ], [ %323, %319 ]
  %321 = getelementptr inbounds [8 x %struct.Way], ptr %2, i64 0, i64 %320
  %322 = load ptr, ptr %321, align 8
  tail call void @free(ptr noundef %322)
  %323 = add nuw nsw i64 %320, 1
  %324 = icmp eq i64 %323, 8
  br i1 %324, label %325, label %319

325:
  call void @llvm.lifetime.end.p0(i64 192, ptr nonnull %2)
  br label %647

326:
  %327 = load i64, ptr %35, align 8
  %328 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 8
  %329 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 1
  %330 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 3
  %331 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 11
  %332 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 12
  %333 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 13
  %334 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 14
  %335 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 7
  %336 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 2
  %337 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 6
  %338 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 9
  %339 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 15
  %340 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 10
  %341 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 16
  br label %342

342:
  %343 = phi i8 [ 0, %326 ], [ %646, %645 ]
  br label %346

344:
  %345 = icmp eq i8 %374, 0
  br i1 %345, label %388, label %384

346:
  %347 = phi i64 [ 0, %342 ], [ %382, %373 ]
  %348 = phi i8 [ %343, %342 ], [ %374, %373 ]
  %349 = phi i8 [ 0, %342 ], [ %381, %373 ]
  %350 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 1, i64 %347
  %351 = load i64, ptr %350, align 8
  %352 = icmp slt i64 %351, 0
  br i1 %352, label %353, label %373

353:
  %354 = trunc i64 %347 to i32
  %355 = call fastcc i32 @take_lane(ptr noundef nonnull %0, i64 noundef %44, ptr noundef nonnull %3, i32 noundef %354)
  %356 = icmp eq i32 %355, 0
  br i1 %356, label %373, label %357

357:
  %358 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %347
  store i64 0, ptr %358, align 8
  %359 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 4, i64 %347
  store i64 0, ptr %359, align 8
  %360 = load i64, ptr %328, align 8
  %361 = icmp sgt i64 %360, -1
  br i1 %361, label %362, label %369

362:
  %363 = load ptr, ptr %3, align 8
  %364 = shl nsw i64 %360, 3
  %365 = add nsw i64 %364, %347
  %366 = getelementptr inbounds double, ptr %363, i64 %365
  %367 = load double, ptr %366, align 8
  %368 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 3, i64 %347
  store double %367, ptr %368, align 8
  br label %369

369:
  %370 = shl nuw i32 1, %354
  %371 = trunc i32 %370 to i8
  %372 = or i8 %348, %371
  br label %373

373:
  %374 = phi i8 [ %372, %369 ], [ %348, %353 ], [ %348, %346 ]
  %375 = load i64, ptr %350, align 8
  %376 = trunc i64 %347 to i32
  %377 = shl nuw i32 1, %376
  %378 = trunc i32 %377 to i8
  %379 = icmp slt i64 %375, 0
  %380 = select i1 %379, i8 0, i8 %378
  %381 = or i8 %380, %349
  %382 = add nuw nsw i64 %347, 1
  %383 = icmp eq i64 %382, 8
  br i1 %383, label %344, label %346

384:
  %385 = load ptr, ptr %49, align 8
  %386 = load ptr, ptr %3, align 8
  %387 = tail call zeroext i8 %385(ptr noundef %386, i8 noundef zeroext %374, i64 noundef %327)
  br label %388

388:
  %389 = icmp eq i8 %381, 0
  br i1 %389, label %645, label %390

390:
  %391 = zext i8 %381 to i32
  %392 = load ptr, ptr %3, align 8
  br label %393

393:
  %394 = load ptr, ptr %329, align 8
  %395 = tail call zeroext i8 %394(ptr noundef %392, i8 noundef zeroext %381, i64 noundef %327)
  %396 = xor i8 %395, -1
  %397 = and i8 %381, %396
  %398 = load ptr, ptr %330, align 8
  %399 = icmp eq ptr %398, null
  br i1 %399, label %588, label %400

400:
  %401 = load i64, ptr %331, align 8
  %402 = shl nsw i64 %401, 3
  %403 = getelementptr inbounds double, ptr %392, i64 %402
  %404 = load i64, ptr %332, align 8
  %405 = shl nsw i64 %404, 3
  %406 = getelementptr inbounds double, ptr %392, i64 %405
  %407 = zext i8 %397 to i32
  br label %410

408:
  %409 = icmp eq i8 %483, 0
  br i1 %409, label %588, label %489

410:
  %411 = phi i64 [ 0, %400 ], [ %487, %486 ]
  %412 = phi i8 [ 0, %400 ], [ %488, %486 ]
  %413 = trunc i64 %411 to i32
  %414 = shl nuw i32 1, %413
  %415 = and i32 %414, %391
  %416 = icmp eq i32 %415, 0
  br i1 %416, label %482, label %417

417:
  %418 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %411
  %419 = load i64, ptr %418, align 8
  %420 = load ptr, ptr %36, align 8
  %421 = icmp eq ptr %420, null
  br i1 %421, label %434, label %422

422:
  %423 = icmp eq i64 %419, 0
  br i1 %423, label %469, label %424

424:
  %425 = load i64, ptr %331, align 8
  %426 = shl nsw i64 %425, 3
  %427 = add nsw i64 %426, %411
  %428 = getelementptr inbounds double, ptr %392, i64 %427
  %429 = load double, ptr %428, align 8
  %430 = getelementptr inbounds %struct.Course, ptr %420, i64 0, i32 3
  %431 = load double, ptr %430, align 8
  %432 = fcmp ogt double %429, %431
  %433 = select i1 %432, double %429, double 0x7FF0000000000000
  br label %469

434:
  %435 = load i64, ptr %37, align 8
  %436 = icmp eq i64 %419, %435
  br i1 %436, label %469, label %437

437:
  %438 = load ptr, ptr %38, align 8
  %439 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 1, i64 %411
  %440 = load i64, ptr %439, align 8
  %441 = load i64, ptr %39, align 8
  %442 = icmp eq i64 %441, 1
  %443 = load ptr, ptr %438, align 8
  br i1 %442, label %444, label %449

444:
  %445 = getelementptr inbounds %struct.Operand, ptr %438, i64 0, i32 1
  %446 = load i64, ptr %445, align 8
  %447 = mul nsw i64 %446, %440
  %448 = getelementptr inbounds double, ptr %443, i64 %447
  br label %465

449:
  %450 = icmp sgt i64 %441, 0
  br i1 %450, label %451, label %465

451:
  %452 = phi i64 [ %455, %451 ], [ %441, %449 ]
  %453 = phi ptr [ %462, %451 ], [ %443, %449 ]
  %454 = phi i64 [ %463, %451 ], [ %440, %449 ]
  %455 = add nsw i64 %452, -1
  %456 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %455
  %457 = load i64, ptr %456, align 8
  %458 = srem i64 %454, %457
  %459 = getelementptr inbounds %struct.Operand, ptr %438, i64 0, i32 1, i64 %455
  %460 = load i64, ptr %459, align 8
  %461 = mul nsw i64 %460, %458
  %462 = getelementptr inbounds double, ptr %453, i64 %461
  %463 = sdiv i64 %454, %457
  %464 = icmp sgt i64 %452, 1
  br i1 %464, label %451, label %465

465:
  %466 = phi ptr [ %448, %444 ], [ %443, %449 ], [ %462, %451 ]
  %467 = getelementptr inbounds double, ptr %466, i64 %419
  %468 = load double, ptr %467, align 8
  br label %469

469:
  %470 = phi double [ %468, %465 ], [ %433, %424 ], [ 0.000000e+00, %422 ], [ 0x7FF0000000000000, %434 ]
  %471 = getelementptr inbounds double, ptr %406, i64 %411
  store double %470, ptr %471, align 8
  %472 = getelementptr inbounds double, ptr %403, i64 %411
  %473 = load double, ptr %472, align 8
  %474 = and i32 %414, %407
  %475 = icmp eq i32 %474, 0
  %476 = select i1 %475, double 1.000000e+00, double 0x3FF000010C6F7A0B
  %477 = fmul double %476, %473
  %478 = fcmp ugt double %470, %477
  %479 = trunc i32 %414 to i8
  %480 = select i1 %478, i8 0, i8 %479
  %481 = or i8 %480, %412
  br label %482

482:
  %483 = phi i8 [ %481, %469 ], [ %412, %410 ]
  %484 = add nuw nsw i64 %411, 1
  %485 = icmp eq i64 %484, 8
  br i1 %485, label %408, label %486

486:
  %487 = phi i64 [ %484, %482 ], [ 0, %585 ]
  %488 = phi i8 [ %483, %482 ], [ 0, %585 ]
  br label %410

489:
  %490 = load ptr, ptr %330, align 8
  %491 = load i64, ptr %35, align 8
  %492 = tail call zeroext i8 %490(ptr noundef %392, i8 noundef zeroext %483, i64 noundef %491)
  %493 = zext i8 %483 to i32
  br label %494

494:
  %495 = phi i64 [ 0, %489 ], [ %586, %585 ]
  %496 = trunc i64 %495 to i32
  %497 = shl nuw i32 1, %496
  %498 = and i32 %497, %493
  %499 = icmp eq i32 %498, 0
  br i1 %499, label %585, label %500

500:
  %501 = load i64, ptr %333, align 8
  %502 = shl nsw i64 %501, 3
  %503 = getelementptr inbounds double, ptr %392, i64 %502
  %504 = getelementptr inbounds double, ptr %503, i64 %495
  %505 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %495
  %506 = load i64, ptr %505, align 8
  %507 = load ptr, ptr %36, align 8
  %508 = icmp eq ptr %507, null
  br i1 %508, label %537, label %509

509:
  %510 = load i64, ptr %332, align 8
  %511 = shl nsw i64 %510, 3
  %512 = add nsw i64 %511, %495
  %513 = getelementptr inbounds double, ptr %392, i64 %512
  %514 = load double, ptr %513, align 8
  %515 = getelementptr inbounds %struct.Course, ptr %507, i64 0, i32 3
  store double %514, ptr %515, align 8
  %516 = add nsw i64 %506, 1
  %517 = getelementptr inbounds %struct.Course, ptr %507, i64 0, i32 2
  store i64 %516, ptr %517, align 8
  %518 = getelementptr inbounds %struct.Course, ptr %507, i64 0, i32 1
  %519 = load i64, ptr %518, align 8
  %520 = icmp slt i64 %506, %519
  br i1 %520, label %521, label %583

521:
  %522 = load i64, ptr %334, align 8
  %523 = icmp sgt i64 %522, 0
  br i1 %523, label %524, label %583

524:
  %525 = phi i64 [ %534, %524 ], [ 0, %521 ]
  %526 = shl nsw i64 %525, 3
  %527 = getelementptr inbounds double, ptr %504, i64 %526
  %528 = load double, ptr %527, align 8
  %529 = load ptr, ptr %507, align 8
  %530 = load i64, ptr %518, align 8
  %531 = mul nsw i64 %530, %525
  %532 = add nsw i64 %531, %506
  %533 = getelementptr inbounds double, ptr %529, i64 %532
  store double %528, ptr %533, align 8
  %534 = add nuw nsw i64 %525, 1
  %535 = load i64, ptr %334, align 8
  %536 = icmp slt i64 %534, %535
  br i1 %536, label %524, label %583

537:
  %538 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 1, i64 %495
  %539 = load i64, ptr %538, align 8
  %540 = load i64, ptr %37, align 8
  %541 = mul nsw i64 %540, %539
  %542 = add nsw i64 %541, %506
  %543 = load ptr, ptr %40, align 8
  %544 = load i64, ptr %335, align 8
  %545 = getelementptr inbounds ptr, ptr %543, i64 %544
  %546 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 2, i64 %495
  %547 = load i64, ptr %546, align 8
  %548 = load i64, ptr %334, align 8
  %549 = load ptr, ptr %0, align 8
  %550 = getelementptr inbounds %struct.Operation, ptr %549, i64 0, i32 6
  %551 = load i64, ptr %550, align 8
  %552 = add nsw i64 %551, 1
  %553 = sdiv i64 %548, %552
  %554 = sub nsw i64 %551, %547
  %555 = load i64, ptr %35, align 8
  %556 = tail call i64 @llvm.smin.i64(i64 %554, i64 %555)
  %557 = add nsw i64 %556, 1
  %558 = mul nsw i64 %557, %553
  %559 = icmp sgt i64 %558, 0
  br i1 %559, label %560, label %583

560:
  %561 = mul nsw i64 %553, %547
  br label %562

562:
  %563 = phi i64 [ 0, %560 ], [ %573, %562 ]
  %564 = shl nsw i64 %563, 3
  %565 = getelementptr inbounds double, ptr %504, i64 %564
  %566 = load double, ptr %565, align 8
  %567 = icmp slt i64 %563, %553
  %568 = select i1 %567, i64 0, i64 %561
  %569 = add nsw i64 %568, %563
  %570 = getelementptr inbounds ptr, ptr %545, i64 %569
  %571 = load ptr, ptr %570, align 8
  %572 = getelementptr inbounds double, ptr %571, i64 %542
  store double %566, ptr %572, align 8
  %573 = add nuw nsw i64 %563, 1
  %574 = load ptr, ptr %0, align 8
  %575 = getelementptr inbounds %struct.Operation, ptr %574, i64 0, i32 6
  %576 = load i64, ptr %575, align 8
  %577 = sub nsw i64 %576, %547
  %578 = load i64, ptr %35, align 8
  %579 = tail call i64 @llvm.smin.i64(i64 %577, i64 %578)
  %580 = add nsw i64 %579, 1
  %581 = mul nsw i64 %580, %553
  %582 = icmp slt i64 %573, %581
  br i1 %582, label %562, label %583

583:
  %584 = add nsw i64 %506, 1
  store i64 %584, ptr %505, align 8
  br label %585

585:
  %586 = add nuw nsw i64 %495, 1
  %587 = icmp eq i64 %586, 8
  br i1 %587, label %486, label %494

588:
  %589 = icmp eq i8 %397, 0
  br i1 %589, label %393, label %590

590:
  %591 = load ptr, ptr %336, align 8
  %592 = tail call zeroext i8 %591(ptr noundef %392, i8 noundef zeroext %397, i64 noundef %327)
  %593 = zext i8 %397 to i32
  br label %594

594:
  %595 = phi i64 [ 0, %590 ], [ %643, %641 ]
  %596 = phi i8 [ 0, %590 ], [ %642, %641 ]
  %597 = trunc i64 %595 to i32
  %598 = shl nuw i32 1, %597
  %599 = and i32 %598, %593
  %600 = icmp eq i32 %599, 0
  br i1 %600, label %641, label %601

601:
  %602 = load i64, ptr %328, align 8
  %603 = icmp slt i64 %602, 0
  br i1 %603, label %639, label %604

604:
  %605 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 4, i64 %595
  %606 = load i64, ptr %605, align 8
  %607 = icmp eq i64 %606, 7
  br i1 %607, label %639, label %608

608:
  %609 = load i64, ptr %337, align 8
  %610 = shl nsw i64 %609, 3
  %611 = getelementptr inbounds double, ptr %392, i64 %610
  %612 = getelementptr inbounds double, ptr %611, i64 %595
  %613 = load i64, ptr %338, align 8
  %614 = shl nsw i64 %613, 3
  %615 = getelementptr inbounds double, ptr %612, i64 %614
  %616 = load double, ptr %615, align 8
  %617 = load double, ptr %339, align 8
  %618 = fcmp une double %616, %617
  br i1 %618, label %639, label %619

619:
  %620 = load i64, ptr %340, align 8
  %621 = shl nsw i64 %620, 3
  %622 = getelementptr inbounds double, ptr %612, i64 %621
  %623 = load double, ptr %622, align 8
  %624 = load double, ptr %341, align 8
  %625 = fcmp ult double %623, %624
  br i1 %625, label %626, label %639

626:
  %627 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 3, i64 %595
  %628 = load double, ptr %627, align 8
  %629 = getelementptr inbounds %struct.Operation, ptr %48, i64 0, i32 1, i64 %44, i32 17, i64 %606
  %630 = load double, ptr %629, align 8
  %631 = fmul double %628, %630
  %632 = shl nsw i64 %602, 3
  %633 = add nsw i64 %632, %595
  %634 = getelementptr inbounds double, ptr %392, i64 %633
  store double %631, ptr %634, align 8
  %635 = add nsw i64 %606, 1
  store i64 %635, ptr %605, align 8
  %636 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 5, i64 %595
  store i64 0, ptr %636, align 8
  %637 = trunc i32 %598 to i8
  %638 = or i8 %596, %637
  br label %641

639:
  call fastcc void @give_lane(ptr noundef nonnull %0, ptr noundef nonnull %49, ptr noundef nonnull %3, i32 noundef %597)
  %640 = getelementptr inbounds %struct.Columns, ptr %3, i64 0, i32 1, i64 %595
  store i64 -1, ptr %640, align 8
  br label %641

641:
  %642 = phi i8 [ %638, %626 ], [ %596, %639 ], [ %596, %594 ]
  %643 = add nuw nsw i64 %595, 1
  %644 = icmp eq i64 %643, 8
  br i1 %644, label %645, label %594

645:
  %646 = phi i8 [ %343, %388 ], [ %642, %641 ]
  br i1 %389, label %647, label %342

647:
  %648 = add nuw nsw i64 %44, 1
  %649 = load i64, ptr %4, align 8
  %650 = icmp slt i64 %648, %649
  br i1 %650, label %43, label %42

651:
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

declare noalias noundef ptr @realloc(ptr allocptr nocapture noundef, i64 noundef) local_unnamed_addr

declare i64 @llvm.smin.i64(i64, i64)

declare i64 @llvm.smax.i64(i64, i64)

