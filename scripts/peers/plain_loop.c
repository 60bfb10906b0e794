/* The peer in C: average acceleration on a mode with N Jenkins elements, every slider visited in
   every force evaluation, Newton's method capped at two evaluations a step, in two forms:

   textbook  Newton's method starts from the committed displacement: evaluates there, corrects, evaluates again;
   saved     it starts from the last step's tangent and stops as soon as the residual vanishes: one evaluation a
             step most of the time.

   Built by scripts/bench with -O3 -march=native -ffast-math, so that the loop over the sliders
   becomes wide SIMD. Case: mode 1 of Table 2 of Deaner et al., 124 Hz, damping ratio 2.5e-4, haversine of
   1.6 ms and amplitude P, dt = 1e-5 s, 20,000 steps.

   usage: plain_loop FILE FORM P REPEATS
   FILE holds one slider a line: strength stiffness. Prints the fastest run's time of a step in ns, the
   displacement at the end and the force evaluations a step. */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double pi = 3.14159265358979323846;

enum { STEPS = 20000, MOST = 1 << 16 };

static double strength[MOST], stiffness[MOST], position[MOST], trial[MOST];
static double history[4][STEPS + 1];
static long evaluations;

/* Force and tangent at u; the sliders' trial positions go to `trial`. */
static double evaluate(int n, double u, double *tangent) {
    double force = 0.0, slope = 0.0;
    for (int i = 0; i < n; i++) {
        double x = u - position[i];
        double held = fmin(fmax(x, -strength[i]), strength[i]);
        trial[i] = u - held;
        force += stiffness[i] * held;
        slope += held == x ? stiffness[i] : 0.0;
    }
    *tangent = slope;
    return force;
}

static void commit(int n) {
    for (int i = 0; i < n; i++) position[i] = trial[i];
}

static double pulse(double t, double amplitude) {
    const double duration = 1.6e-3;
    return t >= duration ? 0.0 : 0.5 * amplitude * (1.0 - cos(2.0 * pi * t / duration));
}

static double run(int n, int textbook, const double *load) {
    const double h = 1e-5, w0 = 2.0 * pi * 124.0, c = 2.0 * 2.5e-4 * w0;
    double k_t = 0.0, q = 0.0, v = 0.0, force = 0.0;
    for (int i = 0; i < n; i++) k_t += stiffness[i], position[i] = 0.0;
    const double k = w0 * w0 - k_t, inertia = 4.0 / (h * h) + 2.0 * c / h + k;
    double slope = k_t, a = load[0];
    for (int step = 1; step <= STEPS; step++) {
        double rhs = load[step] - k * q - force + 4.0 / h * v + a + c * v, now = 0.0;
        double dq = textbook ? 0.0 : rhs / (inertia + slope);
        for (int round = 0; round < 2; round++) {
            evaluations++;
            now = evaluate(n, q + dq, &slope);
            double residual = rhs - inertia * dq - (now - force), change = residual / (inertia + slope);
            if (fabs(change) <= 1e-12 * fabs(dq)) break;
            dq += change, now += slope * change;
        }
        commit(n);
        q += dq, v = 2.0 / h * dq - v, force = now;
        a = load[step] - c * v - k * q - force;
        history[0][step] = q, history[1][step] = v, history[2][step] = a, history[3][step] = force;
    }
    return q;
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    const int textbook = argc == 5 && !strcmp(argv[2], "textbook");
    if (argc != 5 || (!textbook && strcmp(argv[2], "saved")))
        return fprintf(stderr, "usage: plain_loop FILE textbook|saved P REPEATS\n"), 2;
    FILE *file = fopen(argv[1], "r");
    if (!file) return perror(argv[1]), 2;
    int n = 0;
    while (n < MOST && fscanf(file, "%lf %lf", &strength[n], &stiffness[n]) == 2) n++;
    fclose(file);
    double amplitude = atof(argv[3]);
    int repeats = atoi(argv[4]);
    static double load[STEPS + 1], times[1000];
    for (int i = 0; i <= STEPS; i++) load[i] = pulse(i * 1e-5, amplitude);
    if (repeats < 1 || repeats > 1000) return fprintf(stderr, "REPEATS must be 1 to 1000\n"), 2;
    double end = 0.0;
    for (int i = 0; i < repeats; i++) {
        double start = seconds();
        end = run(n, textbook, load);
        times[i] = (seconds() - start) / STEPS * 1e9;
    }
    qsort(times, repeats, sizeof times[0], ascending);
    printf("%.3f %.12e %.3f\n", times[0], end, (double)evaluations / STEPS / repeats);
    return 0;
}
