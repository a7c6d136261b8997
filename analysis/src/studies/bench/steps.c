/* The motion of steps.rs in plain C: a mass with a damper on a delayed spring behind a coupling, with its
 * states in variables and all samples recorded.
 *
 * Reads the numbers of the work; answers `seconds` with the time of a run, and `values` with the positions,
 * velocities and torques of its samples. */

#include <stdio.h>
#include <string.h>
#include <time.h>

enum { STEPS = 10000 };

/* Visible to other files, so that no compiler leaves out a run. */
double position[STEPS], velocity[STEPS], torque[STEPS];

/* Seconds of slide, remaining part of a velocity, position and velocity by a torque held for a period;
 * stiffness, compliance of the coupling, position at the start. */
static double slide, decay, to_position, to_velocity, stiffness, compliance, start;

static void run(void)
{
    double x = start, v = 0.0, due = 0.0;
    for (int k = 0; k < STEPS; k++) {
        position[k] = x;
        velocity[k] = v;
        torque[k] = due;
        double next = stiffness * (x - due * compliance);
        x = x + slide * v - to_position * due;
        v = decay * v - to_velocity * due;
        due = next;
    }
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void print(const double *values)
{
    for (int k = 0; k < STEPS; k++)
        printf("%.17g ", values[k]);
}

int main(void)
{
    char line[64];
    if (scanf("%lf %lf %lf %lf %lf %lf %lf ", &slide, &decay, &to_position, &to_velocity, &stiffness,
              &compliance, &start) != 7)
        return 2;
    while (fgets(line, sizeof line, stdin)) {
        if (strcmp(line, "seconds\n") == 0) {
            /* The second run counts, so that the caches are filled. */
            run();
            double begin = now();
            run();
            printf("%.9e\n", now() - begin);
        } else {
            run();
            print(position);
            print(velocity);
            print(torque);
            printf("\n");
        }
        fflush(stdout);
    }
    return 0;
}
