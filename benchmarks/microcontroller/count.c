/* Instructions of a step of an exported model on a Cortex-M, for qemu-system-arm with -icount shift=0: an instruction takes
 * 1 ns there, and the SysTick timer runs at 25 MHz, so a tick is 40 instructions. measure.sh builds and runs it. */
#include <stdint.h>

#include "model.h"

#define CONTROL (*(volatile uint32_t *)0xE000E010)
#define RELOAD (*(volatile uint32_t *)0xE000E014)
#define CURRENT (*(volatile uint32_t *)0xE000E018)
#define COPROCESSORS (*(volatile uint32_t *)0xE000ED88)
#define TICKS 16777216u
#define INSTRUCTIONS_A_TICK 40u
#define STEPS 2000u

#ifdef TIMED
#define STEP(x) model_step(&model, (x), (model_real)0.001)
#else
#define STEP(x) model_step(&model, (x))
#endif

static model_model model;
static volatile model_real sink;
static volatile uint32_t wraps;

static void on_tick(void) {
    wraps++;
}

static uint32_t now(void) {
    return wraps * TICKS + (TICKS - 1 - CURRENT);
}

static void semihosting(uint32_t operation, const void *argument) {
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : : "r"(r0), "r"(r1) : "memory");
}

static void stop(void) {
    semihosting(0x18, (const void *)0x20026);
    for (;;) {
    }
}

static void print(const char *text) {
    semihosting(0x04, text);
}

static void print_number(uint32_t number) {
    char digits[16];
    int place = 15;
    digits[place] = 0;
    do {
        digits[--place] = (char)('0' + number % 10);
        number /= 10;
    } while (number);
    print(digits + place);
}

/* Straight lines between random turning points, within -9 and 9. */
static model_real drive(void) {
    static uint32_t random = 1;
    static model_real x = 0, velocity = (model_real)0.2;
    x += velocity;
    if (x > 9 || x < -9) {
        velocity = -velocity;
        x += 2 * velocity;
    }
    random = random * 1664525u + 1013904223u;
    if ((random >> 24) < 6) {
        velocity = -velocity;
    }
    return x;
}

/* 10,000 instructions, to check the clock with. */
__attribute__((noinline)) static void ten_thousand(void) {
    __asm__ volatile(".rept 10000\nnop\n.endr");
}

int main(void) {
    uint32_t total = 0, worst = 0;
    RELOAD = TICKS - 1;
    CURRENT = 0;
    CONTROL = 7;
    ten_thousand(); /* The timer counts only after its first reload. */

    uint32_t began = now();
    ten_thousand();
    uint32_t known = (now() - began) * INSTRUCTIONS_A_TICK;
    if (known < 9900 || known > 10200) {
        print("the ticks are not 40 instructions\n");
        stop();
    }

    model_reset(&model);
    for (uint32_t step = 0; step < STEPS; step++) {
        model_real x = drive();
        uint32_t began = now();
        sink = STEP(x);
        uint32_t ticks = now() - began;
        total += ticks;
        worst = ticks > worst ? ticks : worst;
    }
    print("mean ");
    print_number((uint32_t)((uint64_t)total * INSTRUCTIONS_A_TICK / STEPS));
    print(", largest ");
    print_number(worst * INSTRUCTIONS_A_TICK);
    print("\n");
    stop();
}

static void reset(void) {
    COPROCESSORS |= 0xFu << 20;
    __asm__ volatile("dsb\nisb");
    main();
}

__attribute__((section(".vectors"), used)) static void *const vectors[16] = {
    (void *)0x20100000, (void *)reset, (void *)stop, (void *)stop, (void *)stop, (void *)stop, (void *)stop,
    [15] = (void *)on_tick,
};
