/* Keeps eight lanes going, in machine code that this package makes, until none waits.
 *
 * `compute_rows` serves Python: a matrix of inputs, with one column a lane. `impacts`
 * serves XLA: it is the handler of a custom call, whose operands are arrays over axes of
 * lanes.
 *
 * driver.ll is made from this file by `make driver`, which needs clang; what the package
 * needs to run is driver.ll alone. The functions that this file declares `extern` are
 * written by driver.py for the processor at hand.
 */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#define PACK 8 /* lanes in a vector, as in llvm_ir.py */
#define HALF (PACK / 2)
#define AXES 24 /* told in a message too */
#define PROGRAMS 32
#define RETRIES 7
#define ALIGNMENT 64
/* A time after the end of a contact, by up to this part of it, is the end: the duration is
 * that of the last step with a correction, LARGEST_CORRECTION in single.py. */
#define AT_THE_END 1e-6
#define FOR_EVER 0xFFFFFFFF /* milliseconds, on Windows */

typedef uint8_t Mask; /* a bit a column */
/* Works on some columns, and perhaps on others beside them, and on derivatives along so
 * many directions. */
typedef Mask (*Function)(double *work, Mask columns, int64_t directions);

/* What lanes do. A lane's inputs, state and results are a column of the memory `work`,
 * whose rows are eight wide. */
typedef struct {
    Function begin, step, finish;
    Function sample; /* NULL if nothing is sampled on the way */
    int64_t rows, input_rows, results_row, result_rows;
    /* Where the tolerance is among the inputs, outcome and steps are among the results;
     * -1 where a lane that failed is not tried again. */
    int64_t tolerance, outcome, steps;
    /* Of sampling: the rows of the time reached, and of the time asked for; the first
     * row of what is sampled there, and how many they are. */
    int64_t time, asked, sampled_row, sampled_rows;
    /* Code of the outcome `failed`, steps after which it stands, and the factors of the
     * tolerance with which it is tried again. */
    double failed, most_steps, retries[RETRIES];
    /* Of the reverse sweep, from the ends of lanes; NULL where there is none. It has the
     * steps that were accepted, which a row counts, from the last to the first: a tape
     * has so many rows of what each began with. */
    Function from_end, over_step, to_start;
    const int64_t *taped_rows;
    int64_t taped, accepted;
} Program;

/* What the accepted steps of a column began with. */
typedef struct {
    double *rows; /* those of a step side by side */
    int64_t steps, room;
} Tape;

/* Lanes under way. */
typedef struct {
    double *work;
    int64_t lane[PACK];  /* names; -1 in an empty column */
    int64_t first[PACK]; /* of the directions that a column is for */
    double tolerance[PACK];
    int64_t tries[PACK];
    int64_t sampled[PACK]; /* times that are done with */
} Columns;

/* Programs, and what they are computed for. */
typedef struct {
    int64_t count; /* of the programs */
    Program programs[PROGRAMS];
    /* Not zero for a program that is compiled when the first lane needs it: until then it
     * has no functions. */
    int64_t waiting[PROGRAMS];
    /* Compiles a program that is waiting, and puts it in its place. Python's; more than
     * one thread may call it at once. Returns 1, else `problem` says what is wrong: where
     * an exception stops it, it returns 0. */
    int64_t (*make_ready)(int64_t place);
    const char *problem;
    /* Operands are `leaves` inputs that all lanes have in common, tolerance and floor
     * among them; the places of those that lanes have of their own, and one operand for
     * each of these; the effort and the program of a lane; with `directions` the inputs
     * that each is along, with samples the times. */
    int64_t leaves, directions, samples;
    int64_t threads; /* of the handler */
    /* pthread_create and pthread_join; CreateThread, WaitForSingleObject and CloseHandle
     * of Windows. NULL for what the system does not have. */
    int (*create)(void *thread, const void *attributes, void *(*work)(void *), void *);
    int (*join)(uint64_t thread, void **);
    void *(*create_thread)(void *security, size_t stack, uint32_t (*work)(void *), void *,
                           uint32_t flags, uint32_t *number);
    uint32_t (*wait)(void *thread, uint32_t milliseconds);
    int (*close)(void *thread);
} Operation;

Operation operation; /* of the handler; filled in when this code is loaded */

typedef struct {
    const double *data;
    int64_t stride[AXES]; /* 0 along an axis of length 1 */
} Operand;

typedef struct {
    double effort;
    int64_t lane, first;
} Turn;

/* What is sampled of one lane at its start and at the end of every step. */
typedef struct {
    double *samples; /* a row for each thing sampled, with a column a step */
    int64_t room, count;
    double reached;
} Course;

typedef struct {
    Operation *operation;
    int64_t axes, dims[AXES], lanes;
    int64_t threads; /* at most so many */
    int64_t each, shares; /* directions of a column, and columns that a lane has for all */
    int64_t own_inputs; /* of a lane */
    /* NULL for an effort that is the same for all, and where there is one program */
    const Operand *common, *places, *own, *effort, *program, *along, *times_asked;
    double **results; /* a dense array for each row */
    int64_t times;
    Course *course; /* of the only lane; NULL if none is recorded */
    Turn *turns;    /* columns to fill, by program, those that take longest first */
    int64_t next[PROGRAMS], end[PROGRAMS];
    int out_of_memory;
    int not_ready; /* a program that lanes need */
} Job;

extern uint64_t enter_float_mode(void); /* no flushing of small numbers to zero */
extern void leave_float_mode(uint64_t);

static const double *value_of(const Job *job, const Operand *operand, int64_t lane)
{
    if (job->axes == 1) /* no division */
        return operand->data + lane * operand->stride[0];
    const double *data = operand->data;
    for (int64_t axis = job->axes; axis-- > 0; lane /= job->dims[axis])
        data += lane % job->dims[axis] * operand->stride[axis];
    return data;
}

/* How many of so many rows are values; behind them stand as many for each direction. */
static int64_t values_among(const Job *job, int64_t rows)
{
    return rows / (1 + job->operation->directions);
}

/* How many directions a column has that begins with this one. */
static int64_t directions_from(const Job *job, int64_t first)
{
    int64_t left = job->operation->directions - first;
    return left < job->each ? left : job->each;
}

/* Writes the inputs of the next lane into a column and names it; 0 if none waits. */
static int take_lane(Job *job, int64_t place, Columns *columns, int column)
{
    int64_t turn = __atomic_fetch_add(&job->next[place], 1, __ATOMIC_RELAXED);
    if (turn >= job->end[place])
        return 0;
    const Operation *all = job->operation;
    const Program *program = &all->programs[place];
    int64_t lane = job->turns[turn].lane, first = job->turns[turn].first;
    for (int64_t row = 0; row < all->leaves; row++)
        columns->work[PACK * row + column] = job->common->data[row];
    for (int64_t row = all->leaves; row < program->input_rows; row++)
        columns->work[PACK * row + column] = 0.0;
    /* Derivatives of inputs may be among them, those of a direction of any kind. */
    for (int64_t k = 0; k < job->own_inputs; k++) {
        int64_t row = (int64_t)job->places->data[k];
        columns->work[PACK * row + column] = *value_of(job, &job->own[k], lane);
    }
    for (int64_t k = 0; k < directions_from(job, first); k++) {
        int64_t along = (int64_t)job->along->data[first + k];
        int64_t own = (program->input_rows - all->leaves) / all->directions;
        if (along >= 0)
            columns->work[PACK * (all->leaves + k * own + along) + column] = 1.0;
    }
    columns->lane[column] = lane;
    columns->first[column] = first;
    return 1;
}

static void give_lane(Job *job, const Program *program, Columns *columns, int column)
{
    const double *results = columns->work + PACK * program->results_row + column;
    int64_t lane = columns->lane[column], first = columns->first[column];
    int64_t parts = 1 + directions_from(job, first);
    int64_t values = values_among(job, program->result_rows);
    for (int64_t row = 0; row < values * parts; row++)
        job->results[row < values ? row : row + values * first][lane] = results[PACK * row];
    if (job->course)
        return;
    double **samples = job->results + program->result_rows;
    values = values_among(job, program->sampled_rows);
    for (int64_t row = 0; row < values * parts; row++)
        for (int64_t k = columns->sampled[column]; k < job->times; k++)
            samples[row < values ? row : row + values * first][lane * job->times + k] =
                __builtin_nan("");
}

/* Time asked for next by a lane; infinite if none is. */
static double next_time(const Job *job, const Program *program, Columns *columns, int column)
{
    int64_t k = columns->sampled[column];
    if (job->course) {
        /* Where a lane that has failed begins again, so does its course. */
        double time = columns->work[PACK * program->time + column];
        if (k == 0)
            return 0.0;
        return time > job->course->reached ? time : __builtin_inf();
    }
    if (k == job->times)
        return __builtin_inf();
    return value_of(job, job->times_asked, columns->lane[column])[k];
}

static void give_sample(Job *job, const Program *program, Columns *columns, int column)
{
    const double *sampled = columns->work + PACK * program->sampled_row + column;
    int64_t k = columns->sampled[column];
    Course *course = job->course;
    if (course) {
        course->reached = columns->work[PACK * program->asked + column];
        course->count = k + 1;
        if (k < course->room)
            for (int64_t row = 0; row < program->sampled_rows; row++)
                course->samples[row * course->room + k] = sampled[PACK * row];
        return;
    }
    int64_t place = columns->lane[column] * job->times + k;
    double **samples = job->results + program->result_rows;
    int64_t first = columns->first[column], values = values_among(job, program->sampled_rows);
    for (int64_t row = 0; row < values * (1 + directions_from(job, first)); row++)
        samples[row < values ? row : row + values * first][place] = sampled[PACK * row];
}

/* Whether a lane that has ended is to begin again, with a finer tolerance. One that has used
 * up its steps does so once: it takes long, and may have stalled by bad luck. */
static int begins_again(const Program *program, Columns *columns, int column)
{
    if (program->tolerance < 0 || columns->tries[column] == RETRIES)
        return 0;
    const double *results = columns->work + PACK * program->results_row + column;
    if (results[PACK * program->outcome] != program->failed)
        return 0;
    if (results[PACK * program->steps] >= program->most_steps && columns->tries[column] > 0)
        return 0;
    columns->work[PACK * program->tolerance + column] =
        columns->tolerance[column] * program->retries[columns->tries[column]];
    columns->tries[column] += 1;
    columns->sampled[column] = 0;
    return 1;
}

/* Takes samples at all times asked for that lanes have passed, of which some have come to
 * their end. */
static void sample(const Program *program, Columns *columns, Job *job, Mask full, Mask ends)
{
    double *time = columns->work + PACK * program->time;
    double *asked = columns->work + PACK * program->asked;
    for (;;) {
        Mask due = 0;
        for (int column = 0; column < PACK; column++) {
            if (!(full >> column & 1))
                continue;
            asked[column] = next_time(job, program, columns, column);
            double reached = time[column] * (ends >> column & 1 ? 1.0 + AT_THE_END : 1.0);
            if (asked[column] <= reached)
                due |= 1 << column;
        }
        if (!due)
            return;
        program->sample(columns->work, due, job->each);
        for (int column = 0; column < PACK; column++)
            if (due >> column & 1) {
                give_sample(job, program, columns, column);
                columns->sampled[column] += 1;
            }
    }
}

/* Goes on until no lane of a program waits and all columns are empty. */
static void go_on(Job *job, int64_t place, Columns *columns)
{
    const Program *program = &job->operation->programs[place];
    int64_t directions = job->each;
    Mask again = 0;
    for (;;) {
        Mask full = 0, fresh = again;
        for (int column = 0; column < PACK; column++) {
            if (columns->lane[column] < 0 && take_lane(job, place, columns, column)) {
                columns->tries[column] = columns->sampled[column] = 0;
                if (program->tolerance >= 0)
                    columns->tolerance[column] =
                        columns->work[PACK * program->tolerance + column];
                fresh |= 1 << column;
            }
            if (columns->lane[column] >= 0)
                full |= 1 << column;
        }
        if (fresh)
            program->begin(columns->work, fresh, directions);
        if (!full)
            return;
        Mask ends;
        do {
            ends = full & ~program->step(columns->work, full, directions);
            if (program->sample)
                sample(program, columns, job, full, ends);
        } while (!ends);
        program->finish(columns->work, ends, directions);
        again = 0;
        for (int column = 0; column < PACK; column++) {
            if (!(ends >> column & 1))
                continue;
            if (begins_again(program, columns, column)) {
                again |= 1 << column;
            } else {
                give_lane(job, program, columns, column);
                columns->lane[column] = -1;
            }
        }
    }
}

/* Records what the next step begins with; 0 if there is no memory for it. */
static int record(const Program *program, const double *work, Tape *tape, int column)
{
    if (tape->steps == tape->room) {
        int64_t room = tape->room ? 2 * tape->room : 64;
        double *rows = malloc(sizeof(double) * program->taped * room);
        if (!rows)
            return 0;
        for (int64_t k = 0; k < program->taped * tape->steps; k++)
            rows[k] = tape->rows[k];
        free(tape->rows);
        tape->rows = rows;
        tape->room = room;
    }
    double *taped = tape->rows + program->taped * tape->steps;
    for (int64_t k = 0; k < program->taped; k++)
        taped[k] = work[PACK * program->taped_rows[k] + column];
    return 1;
}

/* Forward sweep: steps lanes, all from their start, to their ends; 0 if there is no
 * memory for the tapes. A step must leave a lane that has ended as it is: it waits here for the others. */
static int sweep_forward(const Program *program, Columns *columns, Tape *tapes, Mask full)
{
    double *work = columns->work, *accepted = work + PACK * program->accepted;
    Mask going = full, again = full;
    while (going) {
        if (again)
            program->begin(work, again, 0);
        again = 0;
        for (int column = 0; column < PACK; column++)
            if (going >> column & 1 && !record(program, work, &tapes[column], column))
                return 0;
        Mask ends = going & ~program->step(work, going, 0);
        for (int column = 0; column < PACK; column++)
            if (going >> column & 1)
                tapes[column].steps = (int64_t)accepted[column];
        if (!ends)
            continue;
        program->finish(work, ends, 0);
        for (int column = 0; column < PACK; column++)
            if (ends >> column & 1 && begins_again(program, columns, column)) {
                again |= 1 << column;
                tapes[column].steps = 0;
            }
        going &= ~(ends & ~again);
    }
    return 1;
}

/* Reverse sweep: propagates cotangents back over the steps of lanes that are at their
 * ends. */
static void sweep_back(const Program *program, double *work, const Tape *tapes, Mask full)
{
    int64_t step = 0;
    program->from_end(work, full, 0);
    for (int column = 0; column < PACK; column++)
        if (full >> column & 1 && tapes[column].steps > step)
            step = tapes[column].steps;
    while (step-- > 0) {
        Mask on_tape = 0;
        for (int column = 0; column < PACK; column++) {
            if (!(full >> column & 1) || step >= tapes[column].steps)
                continue;
            on_tape |= 1 << column;
            const double *taped = tapes[column].rows + program->taped * step;
            for (int64_t k = 0; k < program->taped; k++)
                work[PACK * program->taped_rows[k] + column] = taped[k];
        }
        program->over_step(work, on_tape, 0);
    }
    program->to_start(work, full, 0);
}

/* Sweeps lanes of a program forward and back, those of all columns together, until none
 * waits. Lanes side by side have about as many steps: they are in the order of their
 * effort. */
static void sweep_both_ways(Job *job, int64_t place, Columns *columns)
{
    const Program *program = &job->operation->programs[place];
    Tape tapes[PACK] = {{0}};
    for (;;) {
        Mask full = 0;
        for (int column = 0; column < PACK && take_lane(job, place, columns, column); column++) {
            full |= 1 << column;
            tapes[column].steps = columns->tries[column] = columns->sampled[column] = 0;
            if (program->tolerance >= 0)
                columns->tolerance[column] =
                    columns->work[PACK * program->tolerance + column];
        }
        if (!full)
            break;
        if (!sweep_forward(program, columns, tapes, full)) {
            job->out_of_memory = 1;
            break;
        }
        sweep_back(program, columns->work, tapes, full);
        for (int column = 0; column < PACK; column++)
            if (full >> column & 1)
                give_lane(job, program, columns, column);
    }
    for (int column = 0; column < PACK; column++) {
        free(tapes[column].rows);
        columns->lane[column] = -1;
    }
}

static void *work(void *argument)
{
    Job *job = argument;
    const Operation *all = job->operation;
    int64_t rows = 0;
    for (int64_t place = 0; place < all->count; place++)
        if (all->programs[place].rows > rows)
            rows = all->programs[place].rows;
    size_t size = sizeof(double) * PACK * rows;
    void *space = calloc(1, size + ALIGNMENT);
    if (!space) {
        job->out_of_memory = 1;
        return NULL;
    }
    uint64_t mode = enter_float_mode();
    Columns columns;
    columns.work = (double *)(((uintptr_t)space + ALIGNMENT - 1) & ~(uintptr_t)(ALIGNMENT - 1));
    for (int column = 0; column < PACK; column++)
        columns.lane[column] = -1;
    for (int64_t place = 0; place < all->count; place++) {
        if (all->programs[place].over_step)
            sweep_both_ways(job, place, &columns);
        else
            go_on(job, place, &columns);
    }
    leave_float_mode(mode);
    free(space);
    return NULL;
}

static int longer_first(const void *a, const void *b)
{
    const Turn *one = a, *other = b;
    if (one->effort < other->effort)
        return -1;
    if (one->effort > other->effort)
        return 1;
    return (one->lane > other->lane) - (one->lane < other->lane);
}

/* Puts the lanes into the order in which they are to begin. */
static void arrange(Job *job)
{
    int64_t first = 0;
    for (int64_t place = 0; place < job->operation->count; place++) {
        int64_t k = first;
        for (int64_t lane = 0; lane < job->lanes; lane++)
            if (!job->program || (int64_t)*value_of(job, job->program, lane) == place) {
                double effort = job->effort ? *value_of(job, job->effort, lane) : 0.0;
                /* qsort needs an order, which NaN has not. */
                effort = effort == effort ? effort : 0.0;
                for (int64_t share = 0; share < job->shares; share++)
                    job->turns[k++] = (Turn){effort, lane, share * job->each};
            }
        if (job->effort && k - first > PACK)
            qsort(job->turns + first, k - first, sizeof(Turn), longer_first);
        job->next[place] = first;
        job->end[place] = first = k;
    }
}

static uint32_t work_on_windows(void *argument)
{
    work(argument);
    return 0;
}

/* Starts a thread, which is named there; 0 where the system gives none. */
static int start(uint64_t *thread, Job *job)
{
    const Operation *all = job->operation;
    if (all->create)
        return !all->create(thread, NULL, work, job);
    if (!all->create_thread)
        return 0;
    void *handle = all->create_thread(NULL, 0, work_on_windows, job, 0, NULL);
    *thread = (uint64_t)(uintptr_t)handle;
    return handle != NULL;
}

static void await_end(const Operation *all, uint64_t thread)
{
    if (all->join) {
        all->join(thread, NULL);
        return;
    }
    all->wait((void *)(uintptr_t)thread, FOR_EVER);
    all->close((void *)(uintptr_t)thread);
}

/* Divides the directions of one or two lanes among columns that would be empty: they are
 * computed side by side, and every column of a lane has the same values. No more columns
 * than half the lanes: code for vectors of half the lanes takes the least time. */
static void share_out(Job *job)
{
    int64_t directions = job->operation->directions, most = HALF / job->lanes;
    job->each = directions;
    job->shares = 1;
    if (directions < 2 || most < 2)
        return;
    job->each = (directions + most - 1) / most;
    job->shares = (directions + job->each - 1) / job->each;
}

/* Makes the programs ready that lanes need; 0 if one cannot be. */
static int make_ready(Job *job)
{
    Operation *all = job->operation;
    for (int64_t place = 0; place < all->count; place++) {
        if (job->next[place] == job->end[place] ||
            !__atomic_load_n(&all->waiting[place], __ATOMIC_ACQUIRE))
            continue;
        if (all->make_ready(place) != 1) {
            job->not_ready = 1;
            return 0;
        }
        __atomic_store_n(&all->waiting[place], 0, __ATOMIC_RELEASE);
    }
    return 1;
}

static void compute_turns(Job *job, int64_t count)
{
    int64_t threads = (count + PACK - 1) / PACK, started = 1;
    if (threads > job->threads)
        threads = job->threads;
    uint64_t *thread = NULL;
    if (threads > 1)
        thread = malloc(sizeof(uint64_t) * threads);
    if (thread)
        /* Where the system gives no more threads, fewer do the work. */
        while (started < threads && start(&thread[started], job))
            started++;
    work(job);
    for (int64_t k = 1; k < started; k++)
        await_end(job->operation, thread[k]);
    free(thread);
}

/* Computes all lanes of a job, whose results have memory. */
static void compute(Job *job)
{
    share_out(job);
    int64_t count = job->lanes * job->shares;
    job->turns = malloc(sizeof(Turn) * count);
    if (!job->turns) {
        job->out_of_memory = 1;
        return;
    }
    arrange(job);
    if (make_ready(job))
        compute_turns(job, count);
    free(job->turns);
}

/* ---- For Python: matrices with one column a lane. */

typedef struct {
    Operation *operation;
    int64_t lanes, threads, own_inputs, times;
    const double *common, *places; /* as the operands of the handler */
    const double *own;             /* a row for each of the places */
    const double *effort, *program; /* of each lane; or NULL, see Job */
    const double *along;
    const double *times_asked; /* a row for each lane */
    double *results, *samples; /* a row for each, that of a sample has lanes times times */
    Course *course;
} Rows;

/* Returns 0, or 1 if there is too little memory. No program may be waiting. */
int64_t compute_rows(const Rows *rows)
{
    if (!rows->lanes)
        return 0;
    Operation *all = rows->operation;
    int64_t own = rows->own_inputs, count = all->programs[0].result_rows;
    int64_t sampled = rows->course ? 0 : all->programs[0].sampled_rows;
    Operand common = {rows->common, {0}}, places = {rows->places, {0}};
    Operand effort = {rows->effort, {1}}, program = {rows->program, {1}};
    Operand along = {rows->along, {0}}, times = {rows->times_asked, {rows->times}};
    Operand *inputs = calloc(own + 1, sizeof(Operand));
    double **results = malloc(sizeof(double *) * (count + sampled));
    Job job = {.operation = all, .axes = 1, .dims = {rows->lanes}, .lanes = rows->lanes,
               .threads = rows->threads, .own_inputs = own, .common = &common, .places = &places, .own = inputs,
               .effort = rows->effort ? &effort : NULL,
               .program = rows->program ? &program : NULL, .along = &along,
               .times_asked = &times, .results = results, .times = rows->times,
               .course = rows->course};
    if (inputs && results) {
        for (int64_t k = 0; k < own; k++) {
            inputs[k].data = rows->own + k * rows->lanes;
            inputs[k].stride[0] = 1;
        }
        for (int64_t row = 0; row < count; row++)
            results[row] = rows->results + row * rows->lanes;
        for (int64_t row = 0; row < sampled; row++)
            results[count + row] = rows->samples + row * rows->lanes * rows->times;
        compute(&job);
    } else {
        job.out_of_memory = 1;
    }
    free(results);
    free(inputs);
    return job.out_of_memory;
}

/* ---- For XLA: a handler of custom calls. Offsets are those of c_api.h of XLA's FFI. */

#define AT(type, base, offset) (*(type *)((char *)(base) + (offset)))
#define FLOAT64 12
#define EXTENSION_METADATA 1
#define INVALID_ARGUMENT 3
#define RESOURCE_EXHAUSTED 8
#define FAILED_PRECONDITION 9

typedef void *Create(void *arguments);

static void *error(void *frame, int32_t code, const char *message)
{
    struct {
        size_t size;
        void *extension;
        const char *message;
        int32_t code;
    } arguments = {sizeof(arguments), NULL, message, code};
    void *api = AT(void *, frame, 16);
    Create *create = AT(Create *, api, 48);
    return create(&arguments);
}

/* Axes of lanes of an operand, the last `own` left out; what is wrong, or NULL. */
static const char *read_operand(const void *buffer, int64_t own, Job *job, Operand *operand)
{
    int64_t rank = AT(int64_t, buffer, 32), *dims = AT(int64_t *, buffer, 40), stride = 1;
    if (AT(int32_t, buffer, 16) != FLOAT64)
        return "jaximpact computes in float64, but an operand has another type";
    if (rank < own || rank - own > AXES)
        return "jaximpact: impacts take arrays of at most 24 axes, with those of vmap";
    operand->data = AT(double *, buffer, 24);
    job->axes = rank - own;
    for (int64_t axis = rank; axis-- > 0; stride *= dims[axis]) {
        if (axis >= job->axes)
            continue;
        operand->stride[axis] = dims[axis] == 1 ? 0 : stride;
        if (dims[axis] == 1)
            continue;
        if (job->dims[axis] != 1 && job->dims[axis] != dims[axis])
            return "jaximpact: operands do not broadcast";
        job->dims[axis] = dims[axis];
    }
    return NULL;
}

/* Whether a result is an array of float64 of so many elements. */
static int has_room(const void *buffer, int64_t count)
{
    int64_t rank = AT(int64_t, buffer, 32), *dims = AT(int64_t *, buffer, 40), room = 1;
    for (int64_t axis = 0; axis < rank; axis++)
        room *= dims[axis];
    return AT(int32_t, buffer, 16) == FLOAT64 && room == count;
}

static void *compute_call(void *frame, Job *job, Operand *operands, int64_t count)
{
    void **buffers = AT(void **, frame, 72), **results = AT(void **, frame, 112);
    int64_t programs_results = operation.programs[0].result_rows;
    int64_t sampled = operation.programs[0].sampled_rows, axes = -1;
    if (AT(int64_t, frame, 96) != programs_results + sampled)
        return error(frame, INVALID_ARGUMENT, "jaximpact: a wrong number of results");
    for (int64_t axis = 0; axis < AXES; axis++)
        job->dims[axis] = 1;
    for (int64_t k = 0; k < count; k++) {
        /* All lanes' inputs and their places; directions, and times */
        int64_t own = k < 2 || k >= job->own_inputs + 4;
        const char *wrong = read_operand(buffers[k], own, job, &operands[k]);
        if (wrong)
            return error(frame, INVALID_ARGUMENT, wrong);
        if (axes >= 0 && job->axes != axes)
            return error(frame, INVALID_ARGUMENT, "jaximpact: operands differ in their axes");
        axes = job->axes;
    }
    if (operation.samples) {
        const void *times = buffers[count - 1];
        job->times = AT(int64_t *, times, 40)[job->axes];
    }
    if (AT(int64_t *, buffers[0], 40)[job->axes] != operation.leaves)
        return error(frame, INVALID_ARGUMENT, "jaximpact: a wrong number of inputs");
    job->common = operands;
    job->places = operands + 1;
    job->own = operands + 2;
    job->effort = job->own + job->own_inputs;
    job->program = job->effort + 1;
    job->along = job->program + 1;
    job->times_asked = operands + count - 1;
    job->lanes = 1;
    for (int64_t axis = 0; axis < job->axes; axis++)
        job->lanes *= job->dims[axis];
    if (!job->lanes)
        return NULL;
    int64_t rows = programs_results + sampled;
    for (int64_t row = 0; row < rows; row++)
        if (!has_room(results[row], job->lanes * (row < programs_results ? 1 : job->times)))
            return error(frame, INVALID_ARGUMENT,
                         "jaximpact: a result is not float64 of the shape of the lanes");
    double **outputs = malloc(sizeof(double *) * rows);
    job->results = outputs;
    if (outputs) {
        for (int64_t row = 0; row < rows; row++)
            outputs[row] = AT(double *, results[row], 24);
        compute(job);
    } else {
        job->out_of_memory = 1;
    }
    free(outputs);
    if (job->not_ready)
        return error(frame, FAILED_PRECONDITION,
                     operation.problem ? operation.problem : "jaximpact: interrupted");
    if (job->out_of_memory)
        return error(frame, RESOURCE_EXHAUSTED, "jaximpact: out of memory");
    return NULL;
}

void *impacts(void *frame)
{
    void *extension = AT(void *, frame, 8);
    if (extension && AT(int32_t, extension, 8) == EXTENSION_METADATA) {
        void *metadata = AT(void *, extension, 24);
        AT(int32_t, metadata, 24) = 0; /* the version that this follows: 0.1 */
        AT(int32_t, metadata, 28) = 1;
        return NULL;
    }
    int64_t count = AT(int64_t, frame, 56);
    int64_t own_inputs = count - 4 - (operation.directions > 0) - operation.samples;
    if (own_inputs < 0)
        return error(frame, INVALID_ARGUMENT, "jaximpact: too few operands");
    Operand *operands = malloc(sizeof(Operand) * count);
    if (!operands)
        return error(frame, RESOURCE_EXHAUSTED, "jaximpact: out of memory");
    Job job = {.operation = &operation, .threads = operation.threads,
               .own_inputs = own_inputs};
    void *wrong = compute_call(frame, &job, operands, count);
    free(operands);
    return wrong;
}
