; Made from driver.c by 'make driver'; sha256 bdb95b3b2b2b7e941399aeb0a1e2ff207832253dc3b4fb6f056f56dbf1b551d0

%struct.Operation = type { i64, [32 x %struct.Program], i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr }
%struct.Program = type { ptr, ptr, ptr, ptr, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, double, double, [7 x double] }
%struct.Operand = type { ptr, [24 x i64] }
%struct.Job = type { ptr, i64, [24 x i64], i64, i64, i64, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, i64, ptr, ptr, [32 x i64], [32 x i64], i32 }
%struct.Rows = type { ptr, i64, i64, i64, i64, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr, ptr }
%struct.Turn = type { double, i64 }
%struct.anon = type { i64, ptr, ptr, i32 }
%struct.Columns = type { ptr, [8 x i64], [8 x double], [8 x i64], [8 x i64] }
%struct.Course = type { ptr, i64, i64, double }

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
  br i1 %11, label %123, label %12

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
  %48 = shl i64 %10, 4
  %49 = tail call noalias ptr @malloc(i64 noundef %48)
  call void @llvm.lifetime.start.p0(i64 840, ptr nonnull %8)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(840) %8, i8 0, i64 840, i1 false)
  store ptr %13, ptr %8, align 8
  %50 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 1
  store i64 1, ptr %50, align 8
  %51 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 2
  store i64 %10, ptr %51, align 8
  %52 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 3
  store i64 %10, ptr %52, align 8
  %53 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 4
  %54 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 2
  %55 = load i64, ptr %54, align 8
  store i64 %55, ptr %53, align 8
  %56 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 5
  store i64 %15, ptr %56, align 8
  %57 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 6
  store ptr %2, ptr %57, align 8
  %58 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 7
  store ptr %3, ptr %58, align 8
  %59 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 8
  store ptr %44, ptr %59, align 8
  %60 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 9
  %61 = icmp eq ptr %31, null
  %62 = select i1 %61, ptr null, ptr %4
  store ptr %62, ptr %60, align 8
  %63 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 10
  %64 = icmp eq ptr %34, null
  %65 = select i1 %64, ptr null, ptr %5
  store ptr %65, ptr %63, align 8
  %66 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 11
  store ptr %6, ptr %66, align 8
  %67 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 12
  store ptr %7, ptr %67, align 8
  %68 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 13
  store ptr %47, ptr %68, align 8
  %69 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 14
  store i64 %42, ptr %69, align 8
  %70 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 15
  store ptr %19, ptr %70, align 8
  %71 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 16
  store ptr %49, ptr %71, align 8
  %72 = icmp ne ptr %44, null
  %73 = icmp ne ptr %47, null
  %74 = and i1 %72, %73
  %75 = icmp ne ptr %49, null
  %76 = and i1 %74, %75
  br i1 %76, label %77, label %117

77:
  %78 = icmp sgt i64 %15, 0
  br i1 %78, label %79, label %82

79:
  %80 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 7
  %81 = load ptr, ptr %80, align 8
  br label %87

82:
  %83 = icmp sgt i64 %17, 0
  br i1 %83, label %84, label %95

84:
  %85 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 12
  %86 = load ptr, ptr %85, align 8
  br label %101

87:
  %88 = phi i64 [ 0, %79 ], [ %93, %87 ]
  %89 = mul nsw i64 %88, %10
  %90 = getelementptr inbounds double, ptr %81, i64 %89
  %91 = getelementptr inbounds %struct.Operand, ptr %44, i64 %88
  store ptr %90, ptr %91, align 8
  %92 = getelementptr inbounds %struct.Operand, ptr %44, i64 %88, i32 1
  store i64 1, ptr %92, align 8
  %93 = add nuw nsw i64 %88, 1
  %94 = icmp eq i64 %93, %15
  br i1 %94, label %82, label %87

95:
  %96 = icmp sgt i64 %25, 0
  br i1 %96, label %97, label %108

97:
  %98 = getelementptr inbounds %struct.Rows, ptr %0, i64 0, i32 13
  %99 = load ptr, ptr %98, align 8
  %100 = mul i64 %42, %10
  br label %109

101:
  %102 = phi i64 [ 0, %84 ], [ %106, %101 ]
  %103 = mul nsw i64 %102, %10
  %104 = getelementptr inbounds double, ptr %86, i64 %103
  %105 = getelementptr inbounds ptr, ptr %47, i64 %102
  store ptr %104, ptr %105, align 8
  %106 = add nuw nsw i64 %102, 1
  %107 = icmp eq i64 %106, %17
  br i1 %107, label %95, label %101

108:
  call fastcc void @compute(ptr noundef nonnull %8)
  br label %119

109:
  %110 = phi i64 [ 0, %97 ], [ %115, %109 ]
  %111 = mul i64 %100, %110
  %112 = getelementptr inbounds double, ptr %99, i64 %111
  %113 = add nsw i64 %110, %17
  %114 = getelementptr inbounds ptr, ptr %47, i64 %113
  store ptr %112, ptr %114, align 8
  %115 = add nuw nsw i64 %110, 1
  %116 = icmp eq i64 %115, %25
  br i1 %116, label %108, label %109

117:
  %118 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 19
  store i32 1, ptr %118, align 8
  br label %119

119:
  call void @free(ptr noundef %49)
  call void @free(ptr noundef %47)
  call void @free(ptr noundef %44)
  %120 = getelementptr inbounds %struct.Job, ptr %8, i64 0, i32 19
  %121 = load i32, ptr %120, align 8
  %122 = sext i32 %121 to i64
  call void @llvm.lifetime.end.p0(i64 840, ptr nonnull %8)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %7)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %6)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %5)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %4)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %3)
  call void @llvm.lifetime.end.p0(i64 200, ptr nonnull %2)
  br label %123

123:
  %124 = phi i64 [ %122, %119 ], [ 0, %1 ]
  ret i64 %124
}

declare void @llvm.lifetime.start.p0(i64 immarg, ptr nocapture)

declare void @llvm.memset.p0.i64(ptr nocapture writeonly, i8, i64, i1 immarg)

declare noalias noundef ptr @calloc(i64 noundef, i64 noundef) local_unnamed_addr

declare noalias noundef ptr @malloc(i64 noundef) local_unnamed_addr

declare void @llvm.lifetime.end.p0(i64 immarg, ptr nocapture)

define internal fastcc void @compute(ptr noundef %0) unnamed_addr {
  %2 = load ptr, ptr %0, align 8
  %3 = load i64, ptr %2, align 8
  %4 = icmp sgt i64 %3, 0
  br i1 %4, label %5, label %112

5:
  %6 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 3
  %7 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 10
  %8 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 1
  %9 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 9
  %10 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 16
  br label %11

11:
  %12 = phi i64 [ 0, %5 ], [ %17, %105 ]
  %13 = phi i64 [ 0, %5 ], [ %108, %105 ]
  %14 = load i64, ptr %6, align 8
  %15 = icmp sgt i64 %14, 0
  br i1 %15, label %20, label %16

16:
  %17 = phi i64 [ %12, %11 ], [ %95, %94 ]
  %18 = load ptr, ptr %9, align 8
  %19 = icmp eq ptr %18, null
  br i1 %19, label %105, label %99

20:
  %21 = phi i64 [ %96, %94 ], [ 0, %11 ]
  %22 = phi i64 [ %95, %94 ], [ %12, %11 ]
  %23 = load ptr, ptr %7, align 8
  %24 = icmp eq ptr %23, null
  br i1 %24, label %55, label %25

25:
  %26 = load i64, ptr %8, align 8
  %27 = icmp eq i64 %26, 1
  %28 = load ptr, ptr %23, align 8
  br i1 %27, label %29, label %34

29:
  %30 = getelementptr inbounds %struct.Operand, ptr %23, i64 0, i32 1
  %31 = load i64, ptr %30, align 8
  %32 = mul nsw i64 %31, %21
  %33 = getelementptr inbounds double, ptr %28, i64 %32
  br label %50

34:
  %35 = icmp sgt i64 %26, 0
  br i1 %35, label %36, label %50

36:
  %37 = phi i64 [ %40, %36 ], [ %26, %34 ]
  %38 = phi ptr [ %47, %36 ], [ %28, %34 ]
  %39 = phi i64 [ %48, %36 ], [ %21, %34 ]
  %40 = add nsw i64 %37, -1
  %41 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %40
  %42 = load i64, ptr %41, align 8
  %43 = srem i64 %39, %42
  %44 = getelementptr inbounds %struct.Operand, ptr %23, i64 0, i32 1, i64 %40
  %45 = load i64, ptr %44, align 8
  %46 = mul nsw i64 %45, %43
  %47 = getelementptr inbounds double, ptr %38, i64 %46
  %48 = sdiv i64 %39, %42
  %49 = icmp sgt i64 %37, 1
  br i1 %49, label %36, label %50

50:
  %51 = phi ptr [ %33, %29 ], [ %28, %34 ], [ %47, %36 ]
  %52 = load double, ptr %51, align 8
  %53 = fptosi double %52 to i64
  %54 = icmp eq i64 %13, %53
  br i1 %54, label %55, label %94

55:
  %56 = load ptr, ptr %9, align 8
  %57 = icmp eq ptr %56, null
  br i1 %57, label %86, label %58

58:
  %59 = load i64, ptr %8, align 8
  %60 = icmp eq i64 %59, 1
  %61 = load ptr, ptr %56, align 8
  br i1 %60, label %62, label %67

62:
  %63 = getelementptr inbounds %struct.Operand, ptr %56, i64 0, i32 1
  %64 = load i64, ptr %63, align 8
  %65 = mul nsw i64 %64, %21
  %66 = getelementptr inbounds double, ptr %61, i64 %65
  br label %83

67:
  %68 = icmp sgt i64 %59, 0
  br i1 %68, label %69, label %83

69:
  %70 = phi i64 [ %73, %69 ], [ %59, %67 ]
  %71 = phi ptr [ %80, %69 ], [ %61, %67 ]
  %72 = phi i64 [ %81, %69 ], [ %21, %67 ]
  %73 = add nsw i64 %70, -1
  %74 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %73
  %75 = load i64, ptr %74, align 8
  %76 = srem i64 %72, %75
  %77 = getelementptr inbounds %struct.Operand, ptr %56, i64 0, i32 1, i64 %73
  %78 = load i64, ptr %77, align 8
  %79 = mul nsw i64 %78, %76
  %80 = getelementptr inbounds double, ptr %71, i64 %79
  %81 = sdiv i64 %72, %75
  %82 = icmp sgt i64 %70, 1
  br i1 %82, label %69, label %83

83:
  %84 = phi ptr [ %66, %62 ], [ %61, %67 ], [ %80, %69 ]
  %85 = load double, ptr %84, align 8
  br label %86

86:
  %87 = phi double [ %85, %83 ], [ 0.000000e+00, %55 ]
  %88 = load ptr, ptr %10, align 8
  %89 = add nsw i64 %22, 1
  %90 = getelementptr inbounds %struct.Turn, ptr %88, i64 %22
  %91 = fcmp ord double %87, 0.000000e+00
  %92 = select i1 %91, double %87, double 0.000000e+00
  store double %92, ptr %90, align 8
  %93 = getelementptr inbounds i8, ptr %90, i64 8
  store i64 %21, ptr %93, align 8
  br label %94

94:
  %95 = phi i64 [ %89, %86 ], [ %22, %50 ]
  %96 = add nuw nsw i64 %21, 1
  %97 = load i64, ptr %6, align 8
  %98 = icmp slt i64 %96, %97
  br i1 %98, label %20, label %16

99:
  %100 = sub nsw i64 %17, %12
  %101 = icmp sgt i64 %100, 8
  br i1 %101, label %102, label %105

102:
  %103 = load ptr, ptr %10, align 8
  %104 = getelementptr inbounds %struct.Turn, ptr %103, i64 %12
  tail call void @qsort(ptr noundef %104, i64 noundef %100, i64 noundef 16, ptr noundef nonnull @longer_first)
  br label %105

105:
  %106 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 17, i64 %13
  store i64 %12, ptr %106, align 8
  %107 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 18, i64 %13
  store i64 %17, ptr %107, align 8
  %108 = add nuw nsw i64 %13, 1
  %109 = load ptr, ptr %0, align 8
  %110 = load i64, ptr %109, align 8
  %111 = icmp slt i64 %108, %110
  br i1 %111, label %11, label %112

112:
  %113 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 3
  %114 = load i64, ptr %113, align 8
  %115 = add nsw i64 %114, 7
  %116 = sdiv i64 %115, 8
  %117 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 4
  %118 = load i64, ptr %117, align 8
  %119 = tail call i64 @llvm.smin.i64(i64 %116, i64 %118)
  %120 = icmp sgt i64 %119, 1
  br i1 %120, label %121, label %124

121:
  %122 = shl i64 %119, 3
  %123 = tail call noalias ptr @malloc(i64 noundef %122)
  br label %124

124:
  %125 = phi ptr [ %123, %121 ], [ null, %112 ]
  %126 = icmp ne ptr %125, null
  %127 = icmp sgt i64 %119, 1
  %128 = select i1 %126, i1 %127, i1 false
  br i1 %128, label %129, label %152

129:
  %130 = phi i64 [ %150, %149 ], [ 1, %124 ]
  %131 = getelementptr inbounds i64, ptr %125, i64 %130
  %132 = load ptr, ptr %0, align 8
  %133 = getelementptr inbounds %struct.Operation, ptr %132, i64 0, i32 6
  %134 = load ptr, ptr %133, align 8
  %135 = icmp eq ptr %134, null
  br i1 %135, label %139, label %136

136:
  %137 = tail call i32 %134(ptr noundef nonnull %131, ptr noundef null, ptr noundef nonnull @work, ptr noundef nonnull %0)
  %138 = icmp eq i32 %137, 0
  br label %147

139:
  %140 = getelementptr inbounds %struct.Operation, ptr %132, i64 0, i32 8
  %141 = load ptr, ptr %140, align 8
  %142 = icmp eq ptr %141, null
  br i1 %142, label %152, label %143

143:
  %144 = tail call ptr %141(ptr noundef null, i64 noundef 0, ptr noundef nonnull @work_on_windows, ptr noundef nonnull %0, i32 noundef 0, ptr noundef null)
  %145 = ptrtoint ptr %144 to i64
  store i64 %145, ptr %131, align 8
  %146 = icmp ne ptr %144, null
  br label %147

147:
  %148 = phi i1 [ %138, %136 ], [ %146, %143 ]
  br i1 %148, label %149, label %152

149:
  %150 = add nuw nsw i64 %130, 1
  %151 = icmp eq i64 %150, %119
  br i1 %151, label %152, label %129

152:
  %153 = phi i64 [ 1, %124 ], [ %130, %139 ], [ %130, %147 ], [ %150, %149 ]
  %154 = tail call ptr @work(ptr noundef nonnull %0)
  %155 = icmp ugt i64 %153, 1
  br i1 %155, label %157, label %156

156:
  tail call void @free(ptr noundef %125)
  ret void

157:
  %158 = phi i64 [ %176, %175 ], [ 1, %152 ]
  %159 = load ptr, ptr %0, align 8
  %160 = getelementptr inbounds i64, ptr %125, i64 %158
  %161 = load i64, ptr %160, align 8
  %162 = getelementptr inbounds %struct.Operation, ptr %159, i64 0, i32 7
  %163 = load ptr, ptr %162, align 8
  %164 = icmp eq ptr %163, null
  br i1 %164, label %167, label %165

165:
  %166 = tail call i32 %163(i64 noundef %161, ptr noundef null)
  br label %175

167:
  %168 = getelementptr inbounds %struct.Operation, ptr %159, i64 0, i32 9
  %169 = load ptr, ptr %168, align 8
  %170 = inttoptr i64 %161 to ptr
  %171 = tail call i32 %169(ptr noundef %170, i32 noundef -1)
  %172 = getelementptr inbounds %struct.Operation, ptr %159, i64 0, i32 10
  %173 = load ptr, ptr %172, align 8
  %174 = tail call i32 %173(ptr noundef %170)
  br label %175

175:
  %176 = add nuw nsw i64 %158, 1
  %177 = icmp eq i64 %176, %153
  br i1 %177, label %156, label %157
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
  br label %333

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
  br label %333

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
  br label %333

56:
  call void @llvm.lifetime.start.p0(i64 840, ptr nonnull %10)
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(840) %10, i8 0, i64 840, i1 false)
  store ptr @operation, ptr %10, align 8
  %57 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 4
  %58 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 5), align 8
  store i64 %58, ptr %57, align 8
  %59 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 5
  store i64 %32, ptr %59, align 8
  %60 = getelementptr inbounds i8, ptr %0, i64 72
  %61 = load ptr, ptr %60, align 8
  %62 = getelementptr inbounds i8, ptr %0, i64 112
  %63 = load ptr, ptr %62, align 8
  %64 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 1, i64 0, i32 7), align 8
  %65 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 1, i64 0, i32 14), align 8
  %66 = getelementptr inbounds i8, ptr %0, i64 96
  %67 = load i64, ptr %66, align 8
  %68 = add nsw i64 %65, %64
  %69 = icmp eq i64 %67, %68
  br i1 %69, label %90, label %70

70:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %7)
  store i64 32, ptr %7, align 8
  %71 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 1
  store ptr null, ptr %71, align 8
  %72 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 2
  store ptr @.str.2, ptr %72, align 8
  %73 = getelementptr inbounds %struct.anon, ptr %7, i64 0, i32 3
  store i32 3, ptr %73, align 8
  %74 = getelementptr inbounds i8, ptr %0, i64 16
  %75 = load ptr, ptr %74, align 8
  %76 = getelementptr inbounds i8, ptr %75, i64 48
  %77 = load ptr, ptr %76, align 8
  %78 = call ptr %77(ptr noundef nonnull %7)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %7)
  br label %331

79:
  %80 = icmp sgt i64 %25, 0
  br i1 %80, label %81, label %179

81:
  %82 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 1
  %83 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 1
  %84 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 2
  %85 = getelementptr inbounds %struct.anon, ptr %6, i64 0, i32 3
  %86 = getelementptr inbounds i8, ptr %0, i64 16
  %87 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 1
  %88 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 2
  %89 = getelementptr inbounds %struct.anon, ptr %5, i64 0, i32 3
  br label %99

90:
  %91 = phi i64 [ %93, %90 ], [ 0, %56 ]
  %92 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 2, i64 %91
  store i64 1, ptr %92, align 8
  %93 = add nuw nsw i64 %91, 1
  %94 = icmp eq i64 %93, 24
  br i1 %94, label %79, label %90

95:
  %96 = add nuw nsw i64 %103, 1
  %97 = icmp slt i64 %96, %25
  %98 = icmp eq i64 %96, %25
  br i1 %98, label %179, label %99

99:
  %100 = phi i1 [ true, %81 ], [ %97, %95 ]
  %101 = phi ptr [ undef, %81 ], [ %178, %95 ]
  %102 = phi i64 [ -1, %81 ], [ %177, %95 ]
  %103 = phi i64 [ 0, %81 ], [ %96, %95 ]
  %104 = icmp ult i64 %103, 2
  %105 = load i64, ptr %59, align 8
  %106 = add nsw i64 %105, 4
  %107 = icmp sge i64 %103, %106
  %108 = select i1 %104, i1 true, i1 %107
  %109 = zext i1 %108 to i64
  %110 = getelementptr inbounds ptr, ptr %61, i64 %103
  %111 = load ptr, ptr %110, align 8
  %112 = getelementptr inbounds %struct.Operand, ptr %45, i64 %103
  %113 = getelementptr inbounds i8, ptr %111, i64 32
  %114 = load i64, ptr %113, align 8
  %115 = getelementptr inbounds i8, ptr %111, i64 40
  %116 = load ptr, ptr %115, align 8
  %117 = getelementptr inbounds i8, ptr %111, i64 16
  %118 = load i32, ptr %117, align 4
  %119 = icmp eq i32 %118, 12
  br i1 %119, label %120, label %155

120:
  %121 = icmp slt i64 %114, %109
  br i1 %121, label %155, label %122

122:
  %123 = sub nsw i64 %114, %109
  %124 = icmp sgt i64 %123, 24
  br i1 %124, label %155, label %125

125:
  %126 = getelementptr inbounds i8, ptr %111, i64 24
  %127 = load ptr, ptr %126, align 8
  store ptr %127, ptr %112, align 8
  store i64 %123, ptr %82, align 8
  %128 = icmp slt i64 %114, 1
  br i1 %128, label %155, label %129

129:
  %130 = phi i64 [ %132, %150 ], [ %114, %125 ]
  %131 = phi i64 [ %153, %150 ], [ 1, %125 ]
  %132 = add nsw i64 %130, -1
  %133 = load i64, ptr %82, align 8
  %134 = icmp sgt i64 %130, %133
  br i1 %134, label %150, label %135

135:
  %136 = getelementptr inbounds i64, ptr %116, i64 %132
  %137 = load i64, ptr %136, align 8
  %138 = icmp eq i64 %137, 1
  %139 = select i1 %138, i64 0, i64 %131
  %140 = getelementptr inbounds %struct.Operand, ptr %45, i64 %103, i32 1, i64 %132
  store i64 %139, ptr %140, align 8
  %141 = load i64, ptr %136, align 8
  %142 = icmp eq i64 %141, 1
  br i1 %142, label %150, label %143

143:
  %144 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 2, i64 %132
  %145 = load i64, ptr %144, align 8
  %146 = icmp eq i64 %145, 1
  %147 = icmp eq i64 %145, %141
  %148 = select i1 %146, i1 true, i1 %147
  br i1 %148, label %149, label %155

149:
  store i64 %141, ptr %144, align 8
  br label %150

150:
  %151 = getelementptr inbounds i64, ptr %116, i64 %132
  %152 = load i64, ptr %151, align 8
  %153 = mul nsw i64 %152, %131
  %154 = icmp slt i64 %130, 2
  br i1 %154, label %155, label %129

155:
  %156 = phi i1 [ false, %99 ], [ false, %120 ], [ false, %122 ], [ true, %125 ], [ false, %143 ], [ true, %150 ]
  %157 = phi ptr [ @.str.6, %99 ], [ @.str.7, %120 ], [ @.str.7, %122 ], [ null, %125 ], [ @.str.8, %143 ], [ null, %150 ]
  br i1 %156, label %163, label %158

158:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %6)
  store i64 32, ptr %6, align 8
  store ptr null, ptr %83, align 8
  store ptr %157, ptr %84, align 8
  store i32 3, ptr %85, align 8
  %159 = load ptr, ptr %86, align 8
  %160 = getelementptr inbounds i8, ptr %159, i64 48
  %161 = load ptr, ptr %160, align 8
  %162 = call ptr %161(ptr noundef nonnull %6)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %6)
  br label %175

163:
  %164 = icmp slt i64 %102, 0
  %165 = load i64, ptr %82, align 8
  %166 = icmp eq i64 %165, %102
  %167 = select i1 %164, i1 true, i1 %166
  br i1 %167, label %173, label %168

168:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %5)
  store i64 32, ptr %5, align 8
  store ptr null, ptr %87, align 8
  store ptr @.str.3, ptr %88, align 8
  store i32 3, ptr %89, align 8
  %169 = load ptr, ptr %86, align 8
  %170 = getelementptr inbounds i8, ptr %169, i64 48
  %171 = load ptr, ptr %170, align 8
  %172 = call ptr %171(ptr noundef nonnull %5)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %5)
  br label %175

173:
  %174 = load i64, ptr %82, align 8
  br label %175

175:
  %176 = phi i1 [ true, %173 ], [ false, %168 ], [ false, %158 ]
  %177 = phi i64 [ %174, %173 ], [ %102, %168 ], [ %102, %158 ]
  %178 = phi ptr [ %101, %173 ], [ %172, %168 ], [ %162, %158 ]
  br i1 %176, label %95, label %179

179:
  %180 = phi i1 [ %80, %79 ], [ %100, %175 ], [ %97, %95 ]
  %181 = phi ptr [ undef, %79 ], [ %178, %95 ], [ %178, %175 ]
  br i1 %180, label %331, label %182

182:
  %183 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 4), align 8
  %184 = icmp eq i64 %183, 0
  br i1 %184, label %196, label %185

185:
  %186 = add nsw i64 %25, -1
  %187 = getelementptr inbounds ptr, ptr %61, i64 %186
  %188 = load ptr, ptr %187, align 8
  %189 = getelementptr inbounds i8, ptr %188, i64 40
  %190 = load ptr, ptr %189, align 8
  %191 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 1
  %192 = load i64, ptr %191, align 8
  %193 = getelementptr inbounds i64, ptr %190, i64 %192
  %194 = load i64, ptr %193, align 8
  %195 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 14
  store i64 %194, ptr %195, align 8
  br label %196

196:
  %197 = load ptr, ptr %61, align 8
  %198 = getelementptr inbounds i8, ptr %197, i64 40
  %199 = load ptr, ptr %198, align 8
  %200 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 1
  %201 = load i64, ptr %200, align 8
  %202 = getelementptr inbounds i64, ptr %199, i64 %201
  %203 = load i64, ptr %202, align 8
  %204 = load i64, ptr getelementptr inbounds (%struct.Operation, ptr @operation, i64 0, i32 2), align 8
  %205 = icmp eq i64 %203, %204
  br i1 %205, label %215, label %206

206:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %4)
  store i64 32, ptr %4, align 8
  %207 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 1
  store ptr null, ptr %207, align 8
  %208 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 2
  store ptr @.str.4, ptr %208, align 8
  %209 = getelementptr inbounds %struct.anon, ptr %4, i64 0, i32 3
  store i32 3, ptr %209, align 8
  %210 = getelementptr inbounds i8, ptr %0, i64 16
  %211 = load ptr, ptr %210, align 8
  %212 = getelementptr inbounds i8, ptr %211, i64 48
  %213 = load ptr, ptr %212, align 8
  %214 = call ptr %213(ptr noundef nonnull %4)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %4)
  br label %331

215:
  %216 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 6
  store ptr %45, ptr %216, align 8
  %217 = getelementptr inbounds %struct.Operand, ptr %45, i64 1
  %218 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 7
  store ptr %217, ptr %218, align 8
  %219 = getelementptr inbounds %struct.Operand, ptr %45, i64 2
  %220 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 8
  store ptr %219, ptr %220, align 8
  %221 = load i64, ptr %59, align 8
  %222 = getelementptr inbounds %struct.Operand, ptr %219, i64 %221
  %223 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 9
  store ptr %222, ptr %223, align 8
  %224 = getelementptr inbounds %struct.Operand, ptr %222, i64 1
  %225 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 10
  store ptr %224, ptr %225, align 8
  %226 = getelementptr inbounds %struct.Operand, ptr %224, i64 1
  %227 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 11
  store ptr %226, ptr %227, align 8
  %228 = getelementptr inbounds %struct.Operand, ptr %45, i64 %25
  %229 = getelementptr inbounds %struct.Operand, ptr %228, i64 -1
  %230 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 12
  store ptr %229, ptr %230, align 8
  %231 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 3
  store i64 1, ptr %231, align 8
  %232 = icmp sgt i64 %201, 0
  br i1 %232, label %241, label %233

233:
  %234 = load i64, ptr %231, align 8
  %235 = icmp eq i64 %234, 0
  br i1 %235, label %331, label %236

236:
  %237 = icmp sgt i64 %68, 0
  br i1 %237, label %238, label %290

238:
  %239 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 14
  %240 = load i64, ptr %239, align 8
  br label %253

241:
  %242 = phi i64 [ %246, %241 ], [ 1, %215 ]
  %243 = phi i64 [ %247, %241 ], [ 0, %215 ]
  %244 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 2, i64 %243
  %245 = load i64, ptr %244, align 8
  %246 = mul nsw i64 %245, %242
  store i64 %246, ptr %231, align 8
  %247 = add nuw nsw i64 %243, 1
  %248 = icmp eq i64 %247, %201
  br i1 %248, label %233, label %241

249:
  %250 = add nuw nsw i64 %255, 1
  %251 = icmp slt i64 %250, %68
  %252 = icmp eq i64 %250, %68
  br i1 %252, label %290, label %253

253:
  %254 = phi i1 [ true, %238 ], [ %251, %249 ]
  %255 = phi i64 [ 0, %238 ], [ %250, %249 ]
  %256 = getelementptr inbounds ptr, ptr %63, i64 %255
  %257 = load ptr, ptr %256, align 8
  %258 = icmp slt i64 %255, %64
  %259 = select i1 %258, i64 1, i64 %240
  %260 = mul nsw i64 %259, %234
  %261 = getelementptr inbounds i8, ptr %257, i64 32
  %262 = load i64, ptr %261, align 8
  %263 = getelementptr inbounds i8, ptr %257, i64 40
  %264 = load ptr, ptr %263, align 8
  %265 = icmp sgt i64 %262, 0
  br i1 %265, label %266, label %274

266:
  %267 = phi i64 [ %272, %266 ], [ 0, %253 ]
  %268 = phi i64 [ %271, %266 ], [ 1, %253 ]
  %269 = getelementptr inbounds i64, ptr %264, i64 %267
  %270 = load i64, ptr %269, align 8
  %271 = mul nsw i64 %270, %268
  %272 = add nuw nsw i64 %267, 1
  %273 = icmp eq i64 %272, %262
  br i1 %273, label %274, label %266

274:
  %275 = phi i64 [ 1, %253 ], [ %271, %266 ]
  %276 = getelementptr inbounds i8, ptr %257, i64 16
  %277 = load i32, ptr %276, align 4
  %278 = icmp ne i32 %277, 12
  %279 = icmp ne i64 %275, %260
  %280 = select i1 %278, i1 true, i1 %279
  br i1 %280, label %281, label %249

281:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %3)
  store i64 32, ptr %3, align 8
  %282 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 1
  store ptr null, ptr %282, align 8
  %283 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 2
  store ptr @.str.5, ptr %283, align 8
  %284 = getelementptr inbounds %struct.anon, ptr %3, i64 0, i32 3
  store i32 3, ptr %284, align 8
  %285 = getelementptr inbounds i8, ptr %0, i64 16
  %286 = load ptr, ptr %285, align 8
  %287 = getelementptr inbounds i8, ptr %286, i64 48
  %288 = load ptr, ptr %287, align 8
  %289 = call ptr %288(ptr noundef nonnull %3)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %3)
  br label %290

290:
  %291 = phi i1 [ %254, %281 ], [ %237, %236 ], [ %251, %249 ]
  %292 = phi ptr [ %289, %281 ], [ %181, %236 ], [ %181, %249 ]
  br i1 %291, label %331, label %293

293:
  %294 = shl i64 %68, 3
  %295 = call noalias ptr @malloc(i64 noundef %294)
  %296 = load i64, ptr %231, align 8
  %297 = shl i64 %296, 4
  %298 = call noalias ptr @malloc(i64 noundef %297)
  %299 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 16
  store ptr %298, ptr %299, align 8
  %300 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 13
  store ptr %295, ptr %300, align 8
  %301 = icmp eq ptr %295, null
  %302 = icmp eq ptr %298, null
  %303 = or i1 %301, %302
  br i1 %303, label %315, label %304

304:
  br i1 %237, label %306, label %305

305:
  call fastcc void @compute(ptr noundef nonnull %10)
  br label %317

306:
  %307 = phi i64 [ %313, %306 ], [ 0, %304 ]
  %308 = getelementptr inbounds ptr, ptr %63, i64 %307
  %309 = load ptr, ptr %308, align 8
  %310 = getelementptr inbounds i8, ptr %309, i64 24
  %311 = load ptr, ptr %310, align 8
  %312 = getelementptr inbounds ptr, ptr %295, i64 %307
  store ptr %311, ptr %312, align 8
  %313 = add nuw nsw i64 %307, 1
  %314 = icmp eq i64 %313, %68
  br i1 %314, label %305, label %306

315:
  %316 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 19
  store i32 1, ptr %316, align 8
  br label %317

317:
  %318 = load ptr, ptr %299, align 8
  call void @free(ptr noundef %318)
  call void @free(ptr noundef %295)
  %319 = getelementptr inbounds %struct.Job, ptr %10, i64 0, i32 19
  %320 = load i32, ptr %319, align 8
  %321 = icmp eq i32 %320, 0
  br i1 %321, label %331, label %322

322:
  call void @llvm.lifetime.start.p0(i64 32, ptr nonnull %2)
  store i64 32, ptr %2, align 8
  %323 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 1
  store ptr null, ptr %323, align 8
  %324 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 2
  store ptr @.str.1, ptr %324, align 8
  %325 = getelementptr inbounds %struct.anon, ptr %2, i64 0, i32 3
  store i32 8, ptr %325, align 8
  %326 = getelementptr inbounds i8, ptr %0, i64 16
  %327 = load ptr, ptr %326, align 8
  %328 = getelementptr inbounds i8, ptr %327, i64 48
  %329 = load ptr, ptr %328, align 8
  %330 = call ptr %329(ptr noundef nonnull %2)
  call void @llvm.lifetime.end.p0(i64 32, ptr nonnull %2)
  br label %331

331:
  %332 = phi ptr [ %78, %70 ], [ %214, %206 ], [ %181, %179 ], [ null, %233 ], [ %292, %290 ], [ %330, %322 ], [ null, %317 ]
  call void @free(ptr noundef %45)
  call void @llvm.lifetime.end.p0(i64 840, ptr nonnull %10)
  br label %333

333:
  %334 = phi ptr [ null, %18 ], [ %42, %34 ], [ %332, %331 ], [ %55, %47 ]
  ret ptr %334
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
  %22 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 19
  store i32 1, ptr %22, align 8
  br label %506

23:
  %24 = tail call i64 @enter_float_mode()
  call void @llvm.lifetime.start.p0(i64 264, ptr nonnull %2)
  %25 = ptrtoint ptr %11 to i64
  %26 = add i64 %25, 63
  %27 = and i64 %26, -64
  %28 = inttoptr i64 %27 to ptr
  store ptr %28, ptr %2, align 8
  %29 = getelementptr inbounds i8, ptr %2, i64 8
  call void @llvm.memset.p0.i64(ptr noundef nonnull align 8 dereferenceable(64) %29, i8 -1, i64 64, i1 false)
  %30 = load i64, ptr %3, align 8
  %31 = icmp sgt i64 %30, 0
  br i1 %31, label %32, label %44

32:
  %33 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 16
  %34 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 6
  %35 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 5
  %36 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 7
  %37 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 8
  %38 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 1
  %39 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 11
  %40 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 15
  %41 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 14
  %42 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 12
  %43 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 13
  br label %45

44:
  tail call void @leave_float_mode(i64 noundef %24)
  tail call void @free(ptr noundef %11)
  call void @llvm.lifetime.end.p0(i64 264, ptr nonnull %2)
  br label %506

45:
  %46 = phi i64 [ 0, %32 ], [ %503, %502 ]
  %47 = load ptr, ptr %0, align 8
  %48 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46
  %49 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 3
  %50 = load i64, ptr %49, align 8
  %51 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 17, i64 %46
  %52 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 18, i64 %46
  %53 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 8
  %54 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 1
  %55 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 3
  %56 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 11
  %57 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 12
  %58 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 13
  %59 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 14
  %60 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 7
  %61 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 2
  %62 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 6
  %63 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 9
  %64 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 15
  %65 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 10
  %66 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 16
  br label %67

67:
  %68 = phi i8 [ 0, %45 ], [ %501, %500 ]
  br label %71

69:
  %70 = icmp eq i8 %202, 0
  br i1 %70, label %215, label %212

71:
  %72 = phi i64 [ 0, %67 ], [ %210, %201 ]
  %73 = phi i8 [ %68, %67 ], [ %202, %201 ]
  %74 = phi i8 [ 0, %67 ], [ %209, %201 ]
  %75 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %72
  %76 = load i64, ptr %75, align 8
  %77 = icmp slt i64 %76, 0
  br i1 %77, label %78, label %201

78:
  %79 = atomicrmw add ptr %51, i64 1 monotonic, align 8
  %80 = load i64, ptr %52, align 8
  %81 = icmp slt i64 %79, %80
  br i1 %81, label %82, label %201

82:
  %83 = load ptr, ptr %0, align 8
  %84 = load ptr, ptr %33, align 8
  %85 = getelementptr inbounds %struct.Turn, ptr %84, i64 %79, i32 1
  %86 = load i64, ptr %85, align 8
  %87 = getelementptr inbounds %struct.Operation, ptr %83, i64 0, i32 2
  %88 = load i64, ptr %87, align 8
  %89 = icmp sgt i64 %88, 0
  br i1 %89, label %93, label %90

90:
  %91 = load i64, ptr %35, align 8
  %92 = icmp sgt i64 %91, 0
  br i1 %92, label %110, label %105

93:
  %94 = phi i64 [ %102, %93 ], [ 0, %82 ]
  %95 = load ptr, ptr %34, align 8
  %96 = load ptr, ptr %95, align 8
  %97 = getelementptr inbounds double, ptr %96, i64 %94
  %98 = load double, ptr %97, align 8
  %99 = shl nsw i64 %94, 3
  %100 = add nuw nsw i64 %99, %72
  %101 = getelementptr inbounds double, ptr %28, i64 %100
  store double %98, ptr %101, align 8
  %102 = add nuw nsw i64 %94, 1
  %103 = load i64, ptr %87, align 8
  %104 = icmp slt i64 %102, %103
  br i1 %104, label %93, label %90

105:
  %106 = load i64, ptr %87, align 8
  %107 = getelementptr inbounds %struct.Operation, ptr %83, i64 0, i32 1, i64 %46, i32 5
  %108 = load i64, ptr %107, align 8
  %109 = icmp slt i64 %106, %108
  br i1 %109, label %156, label %152

110:
  %111 = phi i64 [ %149, %143 ], [ 0, %90 ]
  %112 = load ptr, ptr %36, align 8
  %113 = load ptr, ptr %112, align 8
  %114 = getelementptr inbounds double, ptr %113, i64 %111
  %115 = load double, ptr %114, align 8
  %116 = fptosi double %115 to i64
  %117 = load ptr, ptr %37, align 8
  %118 = getelementptr inbounds %struct.Operand, ptr %117, i64 %111
  %119 = load i64, ptr %38, align 8
  %120 = icmp eq i64 %119, 1
  %121 = load ptr, ptr %118, align 8
  br i1 %120, label %122, label %127

122:
  %123 = getelementptr inbounds %struct.Operand, ptr %117, i64 %111, i32 1
  %124 = load i64, ptr %123, align 8
  %125 = mul nsw i64 %124, %86
  %126 = getelementptr inbounds double, ptr %121, i64 %125
  br label %143

127:
  %128 = icmp sgt i64 %119, 0
  br i1 %128, label %129, label %143

129:
  %130 = phi i64 [ %133, %129 ], [ %119, %127 ]
  %131 = phi ptr [ %140, %129 ], [ %121, %127 ]
  %132 = phi i64 [ %141, %129 ], [ %86, %127 ]
  %133 = add nsw i64 %130, -1
  %134 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %133
  %135 = load i64, ptr %134, align 8
  %136 = srem i64 %132, %135
  %137 = getelementptr inbounds %struct.Operand, ptr %117, i64 %111, i32 1, i64 %133
  %138 = load i64, ptr %137, align 8
  %139 = mul nsw i64 %138, %136
  %140 = getelementptr inbounds double, ptr %131, i64 %139
  %141 = sdiv i64 %132, %135
  %142 = icmp sgt i64 %130, 1
  br i1 %142, label %129, label %143

143:
  %144 = phi ptr [ %126, %122 ], [ %121, %127 ], [ %140, %129 ]
  %145 = load double, ptr %144, align 8
  %146 = shl nsw i64 %116, 3
  %147 = add nsw i64 %146, %72
  %148 = getelementptr inbounds double, ptr %28, i64 %147
  store double %145, ptr %148, align 8
  %149 = add nuw nsw i64 %111, 1
  %150 = load i64, ptr %35, align 8
  %151 = icmp slt i64 %149, %150
  br i1 %151, label %110, label %105

152:
  %153 = getelementptr inbounds %struct.Operation, ptr %83, i64 0, i32 3
  %154 = load i64, ptr %153, align 8
  %155 = icmp sgt i64 %154, 0
  br i1 %155, label %169, label %164

156:
  %157 = phi i64 [ %161, %156 ], [ %106, %105 ]
  %158 = shl nsw i64 %157, 3
  %159 = add nsw i64 %158, %72
  %160 = getelementptr inbounds double, ptr %28, i64 %159
  store double 0.000000e+00, ptr %160, align 8
  %161 = add nsw i64 %157, 1
  %162 = load i64, ptr %107, align 8
  %163 = icmp slt i64 %161, %162
  br i1 %163, label %156, label %152

164:
  store i64 %86, ptr %75, align 8
  %165 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %72
  store i64 0, ptr %165, align 8
  %166 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 3, i64 %72
  store i64 0, ptr %166, align 8
  %167 = load i64, ptr %53, align 8
  %168 = icmp sgt i64 %167, -1
  br i1 %168, label %190, label %196

169:
  %170 = phi i64 [ %188, %169 ], [ %154, %152 ]
  %171 = phi i64 [ %187, %169 ], [ 0, %152 ]
  %172 = load ptr, ptr %39, align 8
  %173 = load ptr, ptr %172, align 8
  %174 = getelementptr inbounds double, ptr %173, i64 %171
  %175 = load double, ptr %174, align 8
  %176 = fptosi double %175 to i64
  %177 = load i64, ptr %107, align 8
  %178 = load i64, ptr %87, align 8
  %179 = sub nsw i64 %177, %178
  %180 = sdiv i64 %179, %170
  %181 = mul nsw i64 %180, %171
  %182 = add i64 %178, %176
  %183 = add i64 %182, %181
  %184 = shl nsw i64 %183, 3
  %185 = add nsw i64 %184, %72
  %186 = getelementptr inbounds double, ptr %28, i64 %185
  store double 1.000000e+00, ptr %186, align 8
  %187 = add nuw nsw i64 %171, 1
  %188 = load i64, ptr %153, align 8
  %189 = icmp slt i64 %187, %188
  br i1 %189, label %169, label %164

190:
  %191 = shl nsw i64 %167, 3
  %192 = add nsw i64 %191, %72
  %193 = getelementptr inbounds double, ptr %28, i64 %192
  %194 = load double, ptr %193, align 8
  %195 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 2, i64 %72
  store double %194, ptr %195, align 8
  br label %196

196:
  %197 = trunc i64 %72 to i32
  %198 = shl nuw i32 1, %197
  %199 = trunc i32 %198 to i8
  %200 = or i8 %73, %199
  br label %201

201:
  %202 = phi i8 [ %200, %196 ], [ %73, %71 ], [ %73, %78 ]
  %203 = load i64, ptr %75, align 8
  %204 = trunc i64 %72 to i32
  %205 = shl nuw i32 1, %204
  %206 = trunc i32 %205 to i8
  %207 = icmp slt i64 %203, 0
  %208 = select i1 %207, i8 0, i8 %206
  %209 = or i8 %208, %74
  %210 = add nuw nsw i64 %72, 1
  %211 = icmp eq i64 %210, 8
  br i1 %211, label %69, label %71

212:
  %213 = load ptr, ptr %48, align 8
  %214 = tail call zeroext i8 %213(ptr noundef %28, i8 noundef zeroext %202, i64 noundef %50)
  br label %215

215:
  %216 = icmp eq i8 %209, 0
  br i1 %216, label %500, label %217

217:
  %218 = zext i8 %209 to i32
  br label %219

219:
  %220 = load ptr, ptr %54, align 8
  %221 = tail call zeroext i8 %220(ptr noundef %28, i8 noundef zeroext %209, i64 noundef %50)
  %222 = xor i8 %221, -1
  %223 = and i8 %209, %222
  %224 = load ptr, ptr %55, align 8
  %225 = icmp eq ptr %224, null
  br i1 %225, label %387, label %226

226:
  %227 = load i64, ptr %56, align 8
  %228 = shl nsw i64 %227, 3
  %229 = getelementptr inbounds double, ptr %28, i64 %228
  %230 = load i64, ptr %57, align 8
  %231 = shl nsw i64 %230, 3
  %232 = getelementptr inbounds double, ptr %28, i64 %231
  br label %235

233:
  %234 = icmp eq i8 %304, 0
  br i1 %234, label %387, label %310

235:
  %236 = phi i64 [ 0, %226 ], [ %308, %307 ]
  %237 = phi i8 [ 0, %226 ], [ %309, %307 ]
  %238 = trunc i64 %236 to i32
  %239 = shl nuw i32 1, %238
  %240 = and i32 %239, %218
  %241 = icmp eq i32 %240, 0
  br i1 %241, label %303, label %242

242:
  %243 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %236
  %244 = load i64, ptr %243, align 8
  %245 = load ptr, ptr %40, align 8
  %246 = icmp eq ptr %245, null
  br i1 %246, label %259, label %247

247:
  %248 = icmp eq i64 %244, 0
  br i1 %248, label %294, label %249

249:
  %250 = load i64, ptr %56, align 8
  %251 = shl nsw i64 %250, 3
  %252 = add nsw i64 %251, %236
  %253 = getelementptr inbounds double, ptr %28, i64 %252
  %254 = load double, ptr %253, align 8
  %255 = getelementptr inbounds %struct.Course, ptr %245, i64 0, i32 3
  %256 = load double, ptr %255, align 8
  %257 = fcmp ogt double %254, %256
  %258 = select i1 %257, double %254, double 0x7FF0000000000000
  br label %294

259:
  %260 = load i64, ptr %41, align 8
  %261 = icmp eq i64 %244, %260
  br i1 %261, label %294, label %262

262:
  %263 = load ptr, ptr %42, align 8
  %264 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %236
  %265 = load i64, ptr %264, align 8
  %266 = load i64, ptr %38, align 8
  %267 = icmp eq i64 %266, 1
  %268 = load ptr, ptr %263, align 8
  br i1 %267, label %269, label %274

269:
  %270 = getelementptr inbounds %struct.Operand, ptr %263, i64 0, i32 1
  %271 = load i64, ptr %270, align 8
  %272 = mul nsw i64 %271, %265
  %273 = getelementptr inbounds double, ptr %268, i64 %272
  br label %290

274:
  %275 = icmp sgt i64 %266, 0
  br i1 %275, label %276, label %290

276:
  %277 = phi i64 [ %280, %276 ], [ %266, %274 ]
  %278 = phi ptr [ %287, %276 ], [ %268, %274 ]
  %279 = phi i64 [ %288, %276 ], [ %265, %274 ]
  %280 = add nsw i64 %277, -1
  %281 = getelementptr inbounds %struct.Job, ptr %0, i64 0, i32 2, i64 %280
  %282 = load i64, ptr %281, align 8
  %283 = srem i64 %279, %282
  %284 = getelementptr inbounds %struct.Operand, ptr %263, i64 0, i32 1, i64 %280
  %285 = load i64, ptr %284, align 8
  %286 = mul nsw i64 %285, %283
  %287 = getelementptr inbounds double, ptr %278, i64 %286
  %288 = sdiv i64 %279, %282
  %289 = icmp sgt i64 %277, 1
  br i1 %289, label %276, label %290

290:
  %291 = phi ptr [ %273, %269 ], [ %268, %274 ], [ %287, %276 ]
  %292 = getelementptr inbounds double, ptr %291, i64 %244
  %293 = load double, ptr %292, align 8
  br label %294

294:
  %295 = phi double [ %293, %290 ], [ %258, %249 ], [ 0.000000e+00, %247 ], [ 0x7FF0000000000000, %259 ]
  %296 = getelementptr inbounds double, ptr %232, i64 %236
  store double %295, ptr %296, align 8
  %297 = getelementptr inbounds double, ptr %229, i64 %236
  %298 = load double, ptr %297, align 8
  %299 = fcmp ugt double %295, %298
  br i1 %299, label %303, label %300

300:
  %301 = trunc i32 %239 to i8
  %302 = or i8 %237, %301
  br label %303

303:
  %304 = phi i8 [ %302, %300 ], [ %237, %294 ], [ %237, %235 ]
  %305 = add nuw nsw i64 %236, 1
  %306 = icmp eq i64 %305, 8
  br i1 %306, label %233, label %307

307:
  %308 = phi i64 [ %305, %303 ], [ 0, %384 ]
  %309 = phi i8 [ %304, %303 ], [ 0, %384 ]
  br label %235

310:
  %311 = load ptr, ptr %55, align 8
  %312 = load ptr, ptr %0, align 8
  %313 = getelementptr inbounds %struct.Operation, ptr %312, i64 0, i32 3
  %314 = load i64, ptr %313, align 8
  %315 = tail call zeroext i8 %311(ptr noundef %28, i8 noundef zeroext %304, i64 noundef %314)
  %316 = zext i8 %304 to i32
  br label %317

317:
  %318 = phi i64 [ 0, %310 ], [ %385, %384 ]
  %319 = trunc i64 %318 to i32
  %320 = shl nuw i32 1, %319
  %321 = and i32 %320, %316
  %322 = icmp eq i32 %321, 0
  br i1 %322, label %384, label %323

323:
  %324 = load i64, ptr %58, align 8
  %325 = shl nsw i64 %324, 3
  %326 = getelementptr inbounds double, ptr %28, i64 %325
  %327 = getelementptr inbounds double, ptr %326, i64 %318
  %328 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %318
  %329 = load i64, ptr %328, align 8
  %330 = load ptr, ptr %40, align 8
  %331 = icmp eq ptr %330, null
  br i1 %331, label %360, label %332

332:
  %333 = load i64, ptr %57, align 8
  %334 = shl nsw i64 %333, 3
  %335 = add nsw i64 %334, %318
  %336 = getelementptr inbounds double, ptr %28, i64 %335
  %337 = load double, ptr %336, align 8
  %338 = getelementptr inbounds %struct.Course, ptr %330, i64 0, i32 3
  store double %337, ptr %338, align 8
  %339 = add nsw i64 %329, 1
  %340 = getelementptr inbounds %struct.Course, ptr %330, i64 0, i32 2
  store i64 %339, ptr %340, align 8
  %341 = getelementptr inbounds %struct.Course, ptr %330, i64 0, i32 1
  %342 = load i64, ptr %341, align 8
  %343 = icmp slt i64 %329, %342
  br i1 %343, label %344, label %382

344:
  %345 = load i64, ptr %59, align 8
  %346 = icmp sgt i64 %345, 0
  br i1 %346, label %347, label %382

347:
  %348 = phi i64 [ %357, %347 ], [ 0, %344 ]
  %349 = shl nsw i64 %348, 3
  %350 = getelementptr inbounds double, ptr %327, i64 %349
  %351 = load double, ptr %350, align 8
  %352 = load ptr, ptr %330, align 8
  %353 = load i64, ptr %341, align 8
  %354 = mul nsw i64 %353, %348
  %355 = add nsw i64 %354, %329
  %356 = getelementptr inbounds double, ptr %352, i64 %355
  store double %351, ptr %356, align 8
  %357 = add nuw nsw i64 %348, 1
  %358 = load i64, ptr %59, align 8
  %359 = icmp slt i64 %357, %358
  br i1 %359, label %347, label %382

360:
  %361 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %318
  %362 = load i64, ptr %361, align 8
  %363 = load i64, ptr %41, align 8
  %364 = mul nsw i64 %363, %362
  %365 = add nsw i64 %364, %329
  %366 = load i64, ptr %59, align 8
  %367 = icmp sgt i64 %366, 0
  br i1 %367, label %368, label %382

368:
  %369 = phi i64 [ %379, %368 ], [ 0, %360 ]
  %370 = shl nsw i64 %369, 3
  %371 = getelementptr inbounds double, ptr %327, i64 %370
  %372 = load double, ptr %371, align 8
  %373 = load ptr, ptr %43, align 8
  %374 = load i64, ptr %60, align 8
  %375 = add nsw i64 %374, %369
  %376 = getelementptr inbounds ptr, ptr %373, i64 %375
  %377 = load ptr, ptr %376, align 8
  %378 = getelementptr inbounds double, ptr %377, i64 %365
  store double %372, ptr %378, align 8
  %379 = add nuw nsw i64 %369, 1
  %380 = load i64, ptr %59, align 8
  %381 = icmp slt i64 %379, %380
  br i1 %381, label %368, label %382

382:
  %383 = add nsw i64 %329, 1
  store i64 %383, ptr %328, align 8
  br label %384

384:
  %385 = add nuw nsw i64 %318, 1
  %386 = icmp eq i64 %385, 8
  br i1 %386, label %307, label %317

387:
  %388 = icmp eq i8 %223, 0
  br i1 %388, label %219, label %389

389:
  %390 = load ptr, ptr %61, align 8
  %391 = tail call zeroext i8 %390(ptr noundef %28, i8 noundef zeroext %223, i64 noundef %50)
  %392 = zext i8 %223 to i32
  br label %393

393:
  %394 = phi i64 [ 0, %389 ], [ %498, %496 ]
  %395 = phi i8 [ 0, %389 ], [ %497, %496 ]
  %396 = trunc i64 %394 to i32
  %397 = shl nuw i32 1, %396
  %398 = and i32 %397, %392
  %399 = icmp eq i32 %398, 0
  br i1 %399, label %496, label %400

400:
  %401 = load i64, ptr %53, align 8
  %402 = icmp slt i64 %401, 0
  br i1 %402, label %438, label %403

403:
  %404 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 3, i64 %394
  %405 = load i64, ptr %404, align 8
  %406 = icmp eq i64 %405, 7
  br i1 %406, label %438, label %407

407:
  %408 = load i64, ptr %62, align 8
  %409 = shl nsw i64 %408, 3
  %410 = getelementptr inbounds double, ptr %28, i64 %409
  %411 = getelementptr inbounds double, ptr %410, i64 %394
  %412 = load i64, ptr %63, align 8
  %413 = shl nsw i64 %412, 3
  %414 = getelementptr inbounds double, ptr %411, i64 %413
  %415 = load double, ptr %414, align 8
  %416 = load double, ptr %64, align 8
  %417 = fcmp une double %415, %416
  br i1 %417, label %438, label %418

418:
  %419 = load i64, ptr %65, align 8
  %420 = shl nsw i64 %419, 3
  %421 = getelementptr inbounds double, ptr %411, i64 %420
  %422 = load double, ptr %421, align 8
  %423 = load double, ptr %66, align 8
  %424 = fcmp ult double %422, %423
  br i1 %424, label %425, label %438

425:
  %426 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 2, i64 %394
  %427 = load double, ptr %426, align 8
  %428 = getelementptr inbounds %struct.Operation, ptr %47, i64 0, i32 1, i64 %46, i32 17, i64 %405
  %429 = load double, ptr %428, align 8
  %430 = fmul double %427, %429
  %431 = shl nsw i64 %401, 3
  %432 = add nsw i64 %431, %394
  %433 = getelementptr inbounds double, ptr %28, i64 %432
  store double %430, ptr %433, align 8
  %434 = add nsw i64 %405, 1
  store i64 %434, ptr %404, align 8
  %435 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %394
  store i64 0, ptr %435, align 8
  %436 = trunc i32 %397 to i8
  %437 = or i8 %395, %436
  br label %496

438:
  %439 = load i64, ptr %62, align 8
  %440 = shl nsw i64 %439, 3
  %441 = getelementptr inbounds double, ptr %28, i64 %440
  %442 = getelementptr inbounds double, ptr %441, i64 %394
  %443 = load i64, ptr %60, align 8
  %444 = icmp sgt i64 %443, 0
  br i1 %444, label %445, label %448

445:
  %446 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %394
  %447 = load i64, ptr %446, align 8
  br label %458

448:
  %449 = load ptr, ptr %40, align 8
  %450 = icmp eq ptr %449, null
  br i1 %450, label %451, label %494

451:
  %452 = load i64, ptr %59, align 8
  %453 = icmp sgt i64 %452, 0
  br i1 %453, label %454, label %494

454:
  %455 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 4, i64 %394
  %456 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %394
  %457 = load i64, ptr %455, align 8
  br label %470

458:
  %459 = phi i64 [ 0, %445 ], [ %467, %458 ]
  %460 = shl nsw i64 %459, 3
  %461 = getelementptr inbounds double, ptr %442, i64 %460
  %462 = load double, ptr %461, align 8
  %463 = load ptr, ptr %43, align 8
  %464 = getelementptr inbounds ptr, ptr %463, i64 %459
  %465 = load ptr, ptr %464, align 8
  %466 = getelementptr inbounds double, ptr %465, i64 %447
  store double %462, ptr %466, align 8
  %467 = add nuw nsw i64 %459, 1
  %468 = load i64, ptr %60, align 8
  %469 = icmp slt i64 %467, %468
  br i1 %469, label %458, label %448

470:
  %471 = phi i64 [ 0, %454 ], [ %477, %476 ]
  %472 = load i64, ptr %41, align 8
  %473 = icmp slt i64 %457, %472
  br i1 %473, label %474, label %476

474:
  %475 = load i64, ptr %456, align 8
  br label %480

476:
  %477 = add nuw nsw i64 %471, 1
  %478 = load i64, ptr %59, align 8
  %479 = icmp slt i64 %477, %478
  br i1 %479, label %470, label %494

480:
  %481 = phi i64 [ %492, %480 ], [ %472, %474 ]
  %482 = phi i64 [ %491, %480 ], [ %457, %474 ]
  %483 = load ptr, ptr %43, align 8
  %484 = load i64, ptr %60, align 8
  %485 = add nsw i64 %484, %471
  %486 = getelementptr inbounds ptr, ptr %483, i64 %485
  %487 = load ptr, ptr %486, align 8
  %488 = mul nsw i64 %475, %481
  %489 = add nsw i64 %488, %482
  %490 = getelementptr inbounds double, ptr %487, i64 %489
  store double 0x7FF8000000000000, ptr %490, align 8
  %491 = add nsw i64 %482, 1
  %492 = load i64, ptr %41, align 8
  %493 = icmp slt i64 %491, %492
  br i1 %493, label %480, label %476

494:
  %495 = getelementptr inbounds %struct.Columns, ptr %2, i64 0, i32 1, i64 %394
  store i64 -1, ptr %495, align 8
  br label %496

496:
  %497 = phi i8 [ %437, %425 ], [ %395, %494 ], [ %395, %393 ]
  %498 = add nuw nsw i64 %394, 1
  %499 = icmp eq i64 %498, 8
  br i1 %499, label %500, label %393

500:
  %501 = phi i8 [ %68, %215 ], [ %497, %496 ]
  br i1 %216, label %502, label %67

502:
  %503 = add nuw nsw i64 %46, 1
  %504 = load i64, ptr %3, align 8
  %505 = icmp slt i64 %503, %504
  br i1 %505, label %45, label %44

506:
  ret ptr null
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

define internal i32 @work_on_windows(ptr nocapture noundef %0) {
  %2 = tail call ptr @work(ptr noundef %0)
  ret i32 0
}

declare i64 @llvm.smax.i64(i64, i64)

declare i64 @llvm.smin.i64(i64, i64)

