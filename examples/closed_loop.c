/* Tracking with an actuator that has hysteresis: feedforward by the inverse of a model and a PI controller, as in
 * firmware. `actuator` is the export of a model; docs/how-to/closed-loop.md has the commands.
 */
#include <math.h>
#include <stdio.h>

#include "actuator_inverse.h"

#define ROWS 1000
#define STEP 0.01 /* sampling interval in s */
/* Gains in A/um: of those with which the loop is stable at twice the largest slope of the actuator, 64 um/A, the best
 * for the PI controller alone. */
#define KP 0.002
#define KI 0.007

typedef struct {
    actuator_inverse inverse;
    double integral;
    int with_inverse;
} controller;

static void controller_reset(controller *c, int with_inverse)
{
    actuator_inverse_reset(&c->inverse);
    c->integral = 0.0;
    c->with_inverse = with_inverse;
}

/* The current for the next sample, called once in each sampling interval. `error` is the last measured
 * one: measurement and reference of the same sample. */
static double controller_step(controller *c, double wanted, double error)
{
    const double sum = c->integral + KI * error;
    double current = 0.0, output = 0.0;
    /* The inverse follows its own input, not the corrected one, so that no measurement gets into its memory.
     * Its memory then differs from the actuator's by what the correction does: keep the correction small. */
    if (c->with_inverse)
        (void)actuator_inverse_step(&c->inverse, wanted, &current, &output);
    current += KP * error + sum;
    /* Anti-windup: the integral stops while the current is beyond a limit and the error drives it further. */
    if ((current < ACTUATOR_INVERSE_HIGH || error < 0.0) && (current > ACTUATOR_INVERSE_LOW || error > 0.0))
        c->integral = sum;
    return fmin(fmax(current, ACTUATOR_INVERSE_LOW), ACTUATOR_INVERSE_HIGH);
}

/* In place of the real actuator: the model, and a drift of 3 um that the controller does not know. Gives the RMS
 * tracking error in um. */
static double track(int with_inverse)
{
    const double turn = 6.283185307179586;
    static actuator_model actuator;
    static controller c;
    double error = 0.0, late = 0.0, squares = 0.0;
    int k;
    actuator_reset(&actuator);
    controller_reset(&c, with_inverse);
    for (k = 0; k < ROWS; k++) {
        const double time = STEP * k;
        const double wanted = 30.0 + 19.0 * sin(turn * 0.5 * time) + 9.0 * sin(turn * 1.3 * time);
        const double current = controller_step(&c, wanted, late);
        late = error; /* the measurement arrives one sample late */
        error = wanted - (actuator_step(&actuator, current) + 3.0 * (1.0 - exp(-time / 2.0)));
        squares += error * error;
    }
    return sqrt(squares / ROWS);
}

int main(void)
{
    printf("RMS tracking error in um\n");
    printf("PI             %6.3f\n", track(0));
    printf("inverse and PI %6.3f\n", track(1));
    return 0;
}
