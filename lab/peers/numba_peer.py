"""The network in numba: as one would first write it, and as fast as we could make it."""

import os

import llvmlite.binding

# LLVM avoids 512-bit vectors on most processors that have them, for the sake of other code. Here they
# are a third faster. Must be said before numba is imported.
_host_features = llvmlite.binding.get_host_cpu_features().flatten()
if "+avx512f" in _host_features:
    os.environ.setdefault("NUMBA_CPU_FEATURES", _host_features + ",-prefer-256-bit")

import numpy as np
from llvmlite import ir
from numba import njit, prange, types
from numba.extending import intrinsic

from network import FEATURES, HIDDEN, POPULATION, RIDGE, STOPS

FAST = {"nnan", "ninf", "nsz", "arcp", "contract", "afn"}
# Sums need it for vector lanes; tanh must not have it, for it would cancel the rounding.
REORDERED = FAST | {"reassoc"}


# --- As one would first write it -------------------------------------------------------------------


@njit(fastmath=True, error_model="numpy")
def simulate_plainly(stop_weights, beta, linear, hidden, output, x, rate, y):
    """Sample by sample, neuron by neuron."""
    play = np.zeros(STOPS)
    slip = np.zeros(STOPS)
    z = np.zeros(1 + STOPS)
    for j in range(STOPS):
        v = stop_weights[j, 0] * x[0] + stop_weights[j, 1] * rate[0]
        play[j] = min(max(0.0, v - 1.0), v + 1.0)
    for k in range(len(x)):
        z[0] = linear[0] * x[k] + linear[1] * rate[k]
        for j in range(STOPS):
            v = stop_weights[j, 0] * x[k] + stop_weights[j, 1] * rate[k]
            moved = min(max(play[j], v - 1.0), v + 1.0)
            slip[j] += abs(moved - play[j])
            play[j] = moved
            z[1 + j] = (v - moved) * max(0.0, 1.0 - slip[j] / beta[j])
        total = output[0]
        for i in range(HIDDEN):
            a = hidden[i, 0]
            for j in range(1 + STOPS):
                a += hidden[i, 1 + j] * z[j]
            total += output[1 + i] * np.tanh(a)
        y[k] = total


@njit(parallel=True, fastmath=True, error_model="numpy")
def simulate_population_plainly(stop_weights, beta, linear, hidden, output, x, rate, y):
    for p in prange(len(y)):
        simulate_plainly(stop_weights[p], beta[p], linear[p], hidden[p], output[p], x, rate, y[p])


# --- As fast as we could make it -------------------------------------------------------------------
#
# Blocks of rows that lie in the first-level cache. Stops advance side by side in vector lanes; tanh
# neurons have their lanes cut out of time. All work space is one flat array with offsets known to the
# compiler: with separate arrays it must fear that they overlap, and does not use vectors.

BLOCK = 128
LANES = 16

PLAY = 0
SLIP = PLAY + LANES
OF_X = SLIP + LANES
OF_RATE = OF_X + LANES
INVERSE_BETA = OF_RATE + LANES
BY_TIME = INVERSE_BETA + LANES
BY_NEURON = BY_TIME + BLOCK * LANES
H = BY_NEURON + BLOCK * (1 + STOPS)
TARGET = H + BLOCK * HIDDEN
WORK_SPACE = TARGET + BLOCK


@intrinsic
def bits_of(typing_context, value):
    """The bits of a float, as an integer."""

    def generate(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.IntType(64))

    return types.int64(types.float64), generate


@intrinsic
def float_of(typing_context, bits):
    """The float that has these bits."""

    def generate(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.DoubleType())

    return types.float64(types.int64), generate


SIGN = np.int64(-(2**63))
ROUND = 6755399441055744.0 + 1023.0


@njit(fastmath=FAST, error_model="numpy")
def tanh(x):
    """That of crates/hysid-core/src/network/tanh.rs. math.tanh is a call for each number, in no lanes."""
    a = min(abs(x), 20.0)
    rounded = a * (2.0 * 1.4426950408889634) + ROUND
    s = a - (rounded - ROUND) * (0.5 * 0.6931471805599453)
    square = s * s
    cubic = 0.0034639177836130425
    cubic = cubic * square - 0.008858936176728246
    cubic = cubic * square + 0.021869421825241465
    cubic = cubic * square - 0.05396825349959849
    cubic = cubic * square + 0.13333333333212813
    cubic = cubic * square - 0.3333333333333328
    t = square * s * cubic + s
    power = float_of(bits_of(rounded) << 52)
    quotient = ((power + 1.0) * t + (power - 1.0)) / ((power - 1.0) * t + (power + 1.0))
    return float_of(bits_of(quotient) | (bits_of(x) & SIGN))


@njit
def work_space():
    """At the beginning of a cache line: 512-bit vectors across two of them are slow."""
    numbers = 8
    spare = np.empty(WORK_SPACE + numbers)
    first = -(spare.ctypes.data // spare.itemsize) % numbers
    return spare[first : first + WORK_SPACE]


@njit(fastmath=FAST, error_model="numpy")
def begin(stop_weights, beta, x, rate, work):
    work[:] = 0.0
    for j in range(STOPS):
        work[OF_X + j] = stop_weights[j, 0]
        work[OF_RATE + j] = stop_weights[j, 1]
        work[INVERSE_BETA + j] = 1.0 / beta[j]
        v = stop_weights[j, 0] * x[0] + stop_weights[j, 1] * rate[0]
        work[PLAY + j] = min(max(0.0, v - 1.0), v + 1.0)


@njit(fastmath=FAST, error_model="numpy")
def advance_stops(x, rate, first, rows, work):
    for t in range(rows):
        x_t = x[first + t]
        rate_t = rate[first + t]
        for lane in range(LANES):
            v = work[OF_X + lane] * x_t + work[OF_RATE + lane] * rate_t
            before = work[PLAY + lane]
            after = min(max(before, v - 1.0), v + 1.0)
            slip = work[SLIP + lane] + abs(after - before)
            work[PLAY + lane] = after
            work[SLIP + lane] = slip
            strength = max(0.0, 1.0 - slip * work[INVERSE_BETA + lane])
            work[BY_TIME + t * LANES + lane] = (v - after) * strength


@njit(fastmath=FAST, error_model="numpy")
def turn(work):
    for j in range(STOPS):
        for t in range(BLOCK):
            work[BY_NEURON + (1 + j) * BLOCK + t] = work[BY_TIME + t * LANES + j]


@njit(fastmath=REORDERED, error_model="numpy")
def sum_into_hidden(hidden, work):
    for i in range(HIDDEN):
        for t in range(BLOCK):
            a = hidden[i, 0]
            for j in range(1 + STOPS):
                a += hidden[i, 1 + j] * work[BY_NEURON + j * BLOCK + t]
            work[H + i * BLOCK + t] = a


@njit(fastmath=FAST, error_model="numpy")
def tanh_layer(work):
    for k in range(HIDDEN * BLOCK):
        work[H + k] = tanh(work[H + k])


@njit(fastmath=FAST, error_model="numpy")
def advance(linear, hidden, x, rate, first, rows, work):
    """One block through memory and tanh layer."""
    advance_stops(x, rate, first, rows, work)
    for t in range(rows):
        work[BY_NEURON + t] = linear[0] * x[first + t] + linear[1] * rate[first + t]
    turn(work)
    sum_into_hidden(hidden, work)
    tanh_layer(work)


@njit(fastmath=REORDERED, error_model="numpy")
def simulate(stop_weights, beta, linear, hidden, output, x, rate, y):
    work = work_space()
    begin(stop_weights, beta, x, rate, work)
    for first in range(0, len(x), BLOCK):
        rows = min(BLOCK, len(x) - first)
        advance(linear, hidden, x, rate, first, rows, work)
        for t in range(rows):
            total = output[0]
            for i in range(HIDDEN):
                total += output[1 + i] * work[H + i * BLOCK + t]
            y[first + t] = total


@njit(parallel=True, fastmath=REORDERED, error_model="numpy")
def simulate_population(stop_weights, beta, linear, hidden, output, x, rate, y):
    for p in prange(len(y)):
        simulate(stop_weights[p], beta[p], linear[p], hidden[p], output[p], x, rate, y[p])


@njit(fastmath=REORDERED, error_model="numpy")
def add_products(work, gram):
    """Adds a block's sums and products of tanh neurons and target, which follow each other."""
    for i in range(HIDDEN + 1):
        total = 0.0
        for t in range(BLOCK):
            total += work[H + i * BLOCK + t]
        gram[1 + i, 0] += total
        for j in range(i + 1):
            total = 0.0
            for t in range(BLOCK):
                total += work[H + i * BLOCK + t] * work[H + j * BLOCK + t]
            gram[1 + i, 1 + j] += total


@njit(error_model="numpy")
def solve(gram, samples, weights):
    """Output weights from the lower half of the Gram matrix, by Cholesky; returns the mean square
    error."""
    factor = gram / samples
    for i in range(1, FEATURES):
        factor[i, i] += RIDGE
    for i in range(FEATURES + 1):
        for j in range(min(i + 1, FEATURES)):
            for k in range(j):
                factor[i, j] -= factor[i, k] * factor[j, k]
            factor[i, j] = np.sqrt(factor[i, i]) if i == j else factor[i, j] / factor[j, j]
    for i in range(FEATURES - 1, -1, -1):
        weights[i] = factor[FEATURES, i]
        for k in range(i + 1, FEATURES):
            weights[i] -= factor[k, i] * weights[k]
        weights[i] /= factor[i, i]
    mean_square = gram[FEATURES, FEATURES]
    for i in range(FEATURES):
        mean_square -= 2.0 * weights[i] * gram[FEATURES, i]
        for j in range(FEATURES):
            mean_square += weights[i] * weights[j] * gram[max(i, j), min(i, j)]
    return mean_square / samples


@njit(fastmath=REORDERED, error_model="numpy")
def fit_output(stop_weights, beta, linear, hidden, x, rate, target, weights):
    work = work_space()
    gram = np.zeros((FEATURES + 1, FEATURES + 1))
    gram[0, 0] = len(x)
    begin(stop_weights, beta, x, rate, work)
    for first in range(0, len(x), BLOCK):
        rows = min(BLOCK, len(x) - first)
        advance(linear, hidden, x, rate, first, rows, work)
        for t in range(rows):
            work[TARGET + t] = target[first + t]
        for t in range(rows, BLOCK):
            for row in range(HIDDEN + 1):
                work[H + row * BLOCK + t] = 0.0
        add_products(work, gram)
    return solve(gram, len(x), weights)


@njit(parallel=True, fastmath=REORDERED, error_model="numpy")
def fit_population(stop_weights, beta, linear, hidden, x, rate, target, weights, mean_squares):
    for p in prange(len(mean_squares)):
        mean_squares[p] = fit_output(
            stop_weights[p], beta[p], linear[p], hidden[p], x, rate, target, weights[p]
        )


def formulations(case):
    """For each task, ways to do it: a function without arguments for each."""
    y = np.empty(len(case.x))
    population_y = np.empty((POPULATION, len(case.population_x)))
    weights, mean_squares = np.empty((POPULATION, FEATURES)), np.empty(POPULATION)

    def simulated(kernel):
        kernel(*case.network, case.x, case.rate, y)
        return y

    def population_simulated(kernel):
        kernel(*case.population, case.population_x, case.population_rate, population_y)
        return population_y

    drive = (case.population_x, case.population_rate, case.target)
    first = [parameters[0] for parameters in case.population[:4]]

    def fitted():
        return weights[0], fit_output(*first, *drive, weights[0])

    def population_fitted():
        fit_population(*case.population[:4], *drive, weights, mean_squares)
        return weights, mean_squares

    return {
        "simulate": {
            "plain loops": lambda: simulated(simulate_plainly),
            "blocks and lanes": lambda: simulated(simulate),
        },
        "evaluation": {"blocks and lanes, Cholesky": fitted},
        "population": {
            "plain loops, prange": lambda: population_simulated(simulate_population_plainly),
            "blocks and lanes, prange": lambda: population_simulated(simulate_population),
        },
        "population_fit": {"blocks and lanes, Cholesky, prange": population_fitted},
    }
