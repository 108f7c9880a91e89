/* Runs the driver and a kernel on Windows, in the place of XLA: reads `operation` and the
 * operands from the file input, and writes the results to the file output. Sizes, and the
 * offsets of fields of driver.py, are given as the compiler is called. */
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

#define AT(type, base, offset) (*(type *)((char *)(base) + (offset)))
#define FLOAT64 12

typedef struct {
    char head[16];
    long long type;
    void *data;
    long long rank, *dims;
} Buffer;

extern char operation[];
void begin(void), step(void), finish(void), *impacts(void *frame);
int _fltused; /* which objects of Windows ask for */

static double input[COMMON + 1 + 3 * LANES], output[ROWS * LANES];
static long long of_all[] = {1, COMMON}, place[] = {1, 1}, lanes[] = {LANES};

static void *complain(void *error)
{
    puts(AT(char *, error, 16));
    exit(1);
}

int main(void)
{
    FILE *file = fopen("input", "rb");
    fread(operation, 1, OPERATION, file);
    fread(input, sizeof(double), COMMON + 1 + 3 * LANES, file);
    fclose(file);
    AT(void *, operation, BEGIN) = begin;
    AT(void *, operation, STEP) = step;
    AT(void *, operation, FINISH) = finish;
    AT(void *, operation, CREATE_THREAD) = CreateThread;
    AT(void *, operation, WAIT) = WaitForSingleObject;
    AT(void *, operation, CLOSE) = CloseHandle;

    double *own = input + COMMON + 1;
    Buffer given[] = {{"", FLOAT64, input, 2, of_all}, {"", FLOAT64, input + COMMON, 2, place},
                      {"", FLOAT64, own, 1, lanes}, {"", FLOAT64, own + LANES, 1, lanes},
                      {"", FLOAT64, own + 2 * LANES, 1, lanes}};
    Buffer found[ROWS];
    void *operands[5], *results[ROWS];
    for (int k = 0; k < 5; k++)
        operands[k] = &given[k];
    for (int row = 0; row < ROWS; row++) {
        found[row] = (Buffer){"", FLOAT64, output + row * LANES, 1, lanes};
        results[row] = &found[row];
    }
    char api[64] = "", frame[128] = "";
    AT(void *, api, 48) = complain;
    AT(void *, frame, 16) = api;
    AT(long long, frame, 56) = 5;
    AT(void *, frame, 72) = operands;
    AT(long long, frame, 96) = ROWS;
    AT(void *, frame, 112) = results;
    impacts(frame);
    file = fopen("output", "wb");
    fwrite(output, sizeof(double), ROWS * LANES, file);
    fclose(file);
    return 0;
}
