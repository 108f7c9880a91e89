; Keeps eight lanes going until no more are waiting.
;
; A lane's inputs, state and results are a column of %work, whose rows are eight wide;
; %lanes holds the names of the lanes in the columns, or -1 where there is none. Inputs
; and results in memory are matrices with one column a lane.

; Copies one column of a matrix into a column of another.
define internal void @copy(ptr noalias %from, i64 %from_width, i64 %from_place, ptr noalias %to, i64 %to_width, i64 %to_place, i64 %rows) {
entry:
  br label %row
row:
  %i = phi i64 [0, %entry], [%i_next, %row]
  %a0 = mul i64 %i, %from_width
  %a1 = add i64 %a0, %from_place
  %a = getelementptr double, ptr %from, i64 %a1
  %b0 = mul i64 %i, %to_width
  %b1 = add i64 %b0, %to_place
  %b = getelementptr double, ptr %to, i64 %b1
  %x = load double, ptr %a
  store double %x, ptr %b
  %i_next = add i64 %i, 1
  %more = icmp slt i64 %i_next, %rows
  br i1 %more, label %row, label %end
end:
  ret void
}

; Begins the lanes of %inputs, whose names are %names, and goes on until all columns are
; empty or, if %wait, until one is and no lane waits to begin. The results of lanes that
; come to their ends go to the columns of %outputs, which has room for so many, and their
; names to %ended; how many there were is returned.
define i64 @run(ptr noalias %inputs, i64 %count, ptr noalias %names, ptr noalias %outputs, i64 %room, ptr noalias %ended, ptr noalias %lanes, ptr noalias %work, i1 zeroext %wait) {
entry:
  %results = getelementptr double, ptr %work, i64 RESULTS_AT
  br label %look
look:
  %taken = phi i64 [0, %entry], [%k_next, %out_end]
  %done = phi i64 [0, %entry], [%d_next, %out_end]
  br label %slot
slot:                                   ; give a lane to each empty column
  %s = phi i64 [0, %look], [%s_next, %slot_end]
  %k = phi i64 [%taken, %look], [%k_next, %slot_end]
  %fresh = phi i8 [0, %look], [%fresh_next, %slot_end]
  %full = phi i8 [0, %look], [%full_next, %slot_end]
  %s8 = trunc i64 %s to i8
  %bit = shl i8 1, %s8
  %lane_at = getelementptr i64, ptr %lanes, i64 %s
  %lane = load i64, ptr %lane_at
  %is_empty = icmp slt i64 %lane, 0
  %is_waiting = icmp slt i64 %k, %count
  %begins = and i1 %is_empty, %is_waiting
  br i1 %begins, label %slot_begin, label %slot_end
slot_begin:
  call void @copy(ptr %inputs, i64 %count, i64 %k, ptr %work, i64 8, i64 %s, i64 INPUT_ROWS)
  %name_at = getelementptr i64, ptr %names, i64 %k
  %mine = load i64, ptr %name_at
  store i64 %mine, ptr %lane_at
  %k_more = add i64 %k, 1
  %fresh_more = or i8 %fresh, %bit
  br label %slot_end
slot_end:
  %k_next = phi i64 [%k, %slot], [%k_more, %slot_begin]
  %fresh_next = phi i8 [%fresh, %slot], [%fresh_more, %slot_begin]
  %is_left_empty = xor i1 %begins, %is_empty
  %full_bit = select i1 %is_left_empty, i8 0, i8 %bit
  %full_next = or i8 %full, %full_bit
  %s_next = add i64 %s, 1
  %s_more = icmp slt i64 %s_next, 8
  br i1 %s_more, label %slot, label %filled
filled:
  %any_fresh = icmp ne i8 %fresh_next, 0
  br i1 %any_fresh, label %begin, label %begun
begin:
  call i8 @begin(ptr %work, i8 %fresh_next)
  br label %begun
begun:
  %is_idle = icmp eq i8 %full_next, 0
  %is_full = icmp eq i8 %full_next, -1
  %is_short = xor i1 %is_full, true
  %hungers = and i1 %is_short, %wait
  %leaves = or i1 %is_idle, %hungers
  br i1 %leaves, label %exit, label %step
step:
  %going = call i8 @step(ptr %work, i8 -1)
  %stands = xor i8 %going, -1
  %ends = and i8 %full_next, %stands
  %none_ends = icmp eq i8 %ends, 0
  br i1 %none_ends, label %step, label %settle
settle:
  call i8 @finish(ptr %work, i8 -1)
  br label %out
out:                                    ; hand over the results of those that ended
  %o = phi i64 [0, %settle], [%o_next, %out_end]
  %d = phi i64 [%done, %settle], [%d_next, %out_end]
  %o8 = trunc i64 %o to i8
  %o_shifted = lshr i8 %ends, %o8
  %o_ends = trunc i8 %o_shifted to i1
  br i1 %o_ends, label %out_one, label %out_end
out_one:
  %o_lane_at = getelementptr i64, ptr %lanes, i64 %o
  %o_lane = load i64, ptr %o_lane_at
  %ended_at = getelementptr i64, ptr %ended, i64 %d
  store i64 %o_lane, ptr %ended_at
  store i64 -1, ptr %o_lane_at
  call void @copy(ptr %results, i64 8, i64 %o, ptr %outputs, i64 %room, i64 %d, i64 RESULT_ROWS)
  %d_more = add i64 %d, 1
  br label %out_end
out_end:
  %d_next = phi i64 [%d, %out], [%d_more, %out_one]
  %o_next = add i64 %o, 1
  %o_more = icmp slt i64 %o_next, 8
  br i1 %o_more, label %out, label %look
exit:
  ret i64 %done
}
