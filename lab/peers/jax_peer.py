"""The network in JAX: as one would first write it, and rearranged until XLA made the most of it."""

from functools import partial

import jax

jax.config.update("jax_enable_x64", True)

import jax.numpy as jnp
from jax import lax
from jax.sharding import NamedSharding, PartitionSpec

from network import FEATURES, HIDDEN, POPULATION, RIDGE, STOPS, Network


def follow(play, v):
    return jnp.minimum(jnp.maximum(play, v - 1.0), v + 1.0)


def first_play(network, x, rate):
    """The jump from the virgin state, which is no slip."""
    of_x, of_rate = network.stop_weights.T
    return follow(0.0, of_x * x[0] + of_rate * rate[0])


# --- Memory layer: outputs of the stops, each an array over time, and the state at the end ----------


def virgin(network, x, rate):
    return first_play(network, x, rate), jnp.zeros(STOPS)


def scanned(network, state, x, rate):
    """One scan; a step advances all stops as one vector."""
    of_x, of_rate = network.stop_weights.T
    inverse_beta = 1.0 / network.beta

    def step(state, drive):
        play, slip = state
        v = of_x * drive[0] + of_rate * drive[1]
        moved = follow(play, v)
        slip = slip + jnp.abs(moved - play)
        return (moved, slip), (v - moved) * jnp.maximum(0.0, 1.0 - slip * inverse_beta)

    state, z = lax.scan(step, state, (x, rate))
    return state, [z[:, j] for j in range(STOPS)]


def scanned_by_stop(network, state, x, rate):
    """One scan; a step advances each stop on its own, so that outputs come apart."""
    inverse_beta = 1.0 / network.beta

    def step(state, drive):
        moved, z = [], []
        for j, (play, slip) in enumerate(state):
            v = network.stop_weights[j, 0] * drive[0] + network.stop_weights[j, 1] * drive[1]
            after = follow(play, v)
            slip = slip + jnp.abs(after - play)
            moved.append((after, slip))
            z.append((v - after) * jnp.maximum(0.0, 1.0 - slip * inverse_beta[j]))
        return moved, z

    plays, slips = state
    state, z = lax.scan(step, [(plays[j], slips[j]) for j in range(STOPS)], (x, rate), unroll=8)
    return (jnp.stack([play for play, _ in state]), jnp.stack([slip for _, slip in state])), z


def then(first, second):
    """Two moves of a play are one: clips compose to a clip. So a play is a prefix sum."""
    clip = lambda bound: jnp.minimum(jnp.maximum(bound, second[0]), second[1])
    return clip(first[0]), clip(first[1])


def prefix_sums(network, state, x, rate):
    """Associative scans over all of time."""
    play, slip = state
    v = network.stop_weights @ jnp.stack([x, rate])
    low, high = lax.associative_scan(then, (v - 1.0, v + 1.0), axis=1)
    moved = jnp.minimum(jnp.maximum(play[:, None], low), high)
    slips = slip[:, None] + jnp.cumsum(jnp.abs(jnp.diff(moved, axis=1, prepend=play[:, None])), axis=1)
    z = (v - moved) * jnp.maximum(0.0, 1.0 - slips / network.beta[:, None])
    return (moved[:, -1], slips[:, -1]), list(z)


# --- Readout ----------------------------------------------------------------------------------------


def tanh_neurons(network, x, rate, z):
    """Sums written out, which XLA fuses with the tanh into one loop."""
    z = [network.linear[0] * x + network.linear[1] * rate, *z]
    h = []
    for i in range(HIDDEN):
        a = network.hidden[i, 0]
        for j in range(1 + STOPS):
            a = a + network.hidden[i, 1 + j] * z[j]
        h.append(jnp.tanh(a))
    return h


def tanh_neurons_by_matrix(network, x, rate, z):
    """One matrix product, as one would first write it."""
    z = jnp.stack([network.linear[0] * x + network.linear[1] * rate, *z])
    return jnp.tanh(network.hidden[:, :1] + network.hidden[:, 1:] @ z)


def output(network, h):
    total = network.output[0]
    for i in range(HIDDEN):
        total = total + network.output[1 + i] * h[i]
    return total


# --- Simulation ---------------------------------------------------------------------------------------


def simulate(memory, readout, network, x, rate):
    _, z = memory(network, virgin(network, x, rate), x, rate)
    return output(network, readout(network, x, rate, z))


def simulate_in_blocks(memory, rows, network, x, rate):
    """A scan over blocks that stay in the cache from memory to output."""

    def block(state, drive):
        state, z = memory(network, state, *drive)
        return state, output(network, tanh_neurons(network, *drive, z))

    whole = len(x) - len(x) % rows
    drive = x[:whole].reshape(-1, rows), rate[:whole].reshape(-1, rows)
    state, y = lax.scan(block, virgin(network, x, rate), drive)
    if whole == len(x):
        return y.reshape(-1)
    _, rest = block(state, (x[whole:], rate[whole:]))
    return jnp.concatenate([y.reshape(-1), rest])


def simulate_spans(spans, network, x, rate):
    """Time cut into spans that run side by side in vector lanes. Three passes: what each span does to
    the plays, what it adds to the slips, then the output, each span from its true beginning."""
    x, rate = x.reshape(spans, -1).T, rate.reshape(spans, -1).T
    inverse_beta = 1.0 / network.beta
    play = first_play(network, x[:, 0], rate[:, 0])

    def driven(j, drive):
        return network.stop_weights[j, 0] * drive[0] + network.stop_weights[j, 1] * drive[1]

    def clip(clips, drive):
        v = [driven(j, drive) for j in range(STOPS)]
        return [then(clips[j], (v[j] - 1.0, v[j] + 1.0)) for j in range(STOPS)], None

    def slide(states, drive):
        moved = []
        for j, (play, slip) in enumerate(states):
            after = follow(play, driven(j, drive))
            moved.append((after, slip + jnp.abs(after - play)))
        return moved, None

    def read(states, drive):
        states, _ = slide(states, drive)
        z = [
            (driven(j, drive) - play) * jnp.maximum(0.0, 1.0 - slip * inverse_beta[j])
            for j, (play, slip) in enumerate(states)
        ]
        return states, output(network, tanh_neurons(network, *drive, z))

    # Beyond any play, and finite: XLA may be told that there are no infinities.
    anything = (jnp.full(spans, -1e300), jnp.full(spans, 1e300))
    clips, _ = lax.scan(clip, [anything] * STOPS, (x, rate), unroll=2)
    plays = []
    for j in range(STOPS):
        low, high = lax.associative_scan(then, clips[j])
        ends = jnp.minimum(jnp.maximum(play[j], low), high)
        plays.append(jnp.concatenate([play[j][None], ends[:-1]]))
    slid, _ = lax.scan(slide, [(plays[j], jnp.zeros(spans)) for j in range(STOPS)], (x, rate), unroll=2)
    starts = [(plays[j], jnp.cumsum(slip) - slip) for j, (_, slip) in enumerate(slid)]
    _, y = lax.scan(read, starts, (x, rate), unroll=2)
    return y.T.reshape(-1)


# --- Population -----------------------------------------------------------------------------------------


def fit_output(memory, readout, network, x, rate, target):
    """Output weights by least squares, and the mean square error."""
    _, z = memory(network, virgin(network, x, rate), x, rate)
    h = readout(network, x, rate, z)
    phi = jnp.stack([jnp.ones_like(x), *h, target])
    gram = phi @ phi.T / len(x)
    matrix, right = gram[:FEATURES, :FEATURES], gram[:FEATURES, FEATURES]
    penalty = RIDGE * jnp.diag(jnp.array([0.0] + [1.0] * HIDDEN))
    factor = jax.scipy.linalg.cho_factor(matrix + penalty, lower=True)
    weights = jax.scipy.linalg.cho_solve(factor, right)
    return weights, gram[FEATURES, FEATURES] + weights @ (matrix @ weights - 2.0 * right)


def side_by_side(one):
    """All individuals in lanes."""
    return lambda population, *drive: jax.vmap(lambda network: one(network, *drive))(population)


def in_turn(one, at_once=None):
    """One or a few individuals at a time, which stay in the cache."""
    return lambda population, *drive: lax.map(
        lambda network: one(network, *drive), population, batch_size=at_once
    )


def on_devices(evaluate, population, drive):
    """The evaluation as a function without arguments, with the population split over the devices (one
    for each core, or only one)."""
    devices = jax.device_count()
    if devices == 1:
        compiled = jax.jit(evaluate)
        return lambda: jax.block_until_ready(compiled(population, *drive))
    mesh = jax.make_mesh((devices,), ("individuals",))
    split, whole = PartitionSpec("individuals"), PartitionSpec()
    sharded = jax.shard_map(
        evaluate, mesh=mesh, in_specs=(split,) + (whole,) * len(drive), out_specs=split, check_vma=False
    )
    compiled = jax.jit(sharded)
    # Every device gets the same number: where they do not divide evenly, some individuals twice.
    padded = -(-POPULATION // devices) * devices
    place = lambda value, spec: jax.device_put(value, NamedSharding(mesh, spec))
    population = Network(*(place(jnp.resize(p, (padded, *p.shape[1:])), split) for p in population))
    drive = [place(value, whole) for value in drive]
    return lambda: jax.block_until_ready(compiled(population, *drive))


def simulations(case):
    """Ways to simulate: a function without arguments for each."""
    network = Network(*map(jnp.asarray, case.network))
    x, rate = jnp.asarray(case.x), jnp.asarray(case.rate)
    ways = {
        "scan, matrix product": partial(simulate, scanned, tanh_neurons_by_matrix),
        "scan": partial(simulate, scanned, tanh_neurons),
        "associative_scan": partial(simulate, prefix_sums, tanh_neurons),
        "associative_scan in blocks of 4000": partial(simulate_in_blocks, prefix_sums, 4000),
        "scan in blocks of 1000": partial(simulate_in_blocks, scanned, 1000),
        "scan by stop in blocks of 1000": partial(simulate_in_blocks, scanned_by_stop, 1000),
    }
    for spans in (64, 250):
        if len(case.x) % spans == 0:
            ways[f"{spans} spans of time in lanes"] = partial(simulate_spans, spans)

    def prepared(way):
        compiled = jax.jit(way)
        return lambda: jax.block_until_ready(compiled(network, x, rate))

    return {name: prepared(way) for name, way in ways.items()}


def evaluations(case):
    """Ways to evaluate one individual with its least squares."""
    network = Network(*(jnp.asarray(parameters[0]) for parameters in case.population))
    drive = [jnp.asarray(values) for values in (case.population_x, case.population_rate, case.target)]
    memories = {"scan": scanned, "scan by stop": scanned_by_stop}
    readouts = {"": tanh_neurons, ", matrix product": tanh_neurons_by_matrix}

    def prepared(memory, readout):
        compiled = jax.jit(partial(fit_output, memory, readout))
        return lambda: jax.block_until_ready(compiled(network, *drive))

    return {
        memory + readout: prepared(memories[memory], readouts[readout])
        for memory in memories
        for readout in readouts
    }


def population_formulations(case):
    """Ways to evaluate the population, with given and with fitted output weights."""
    population = Network(*map(jnp.asarray, case.population))
    drive = jnp.asarray(case.population_x), jnp.asarray(case.population_rate)
    target = jnp.asarray(case.target)
    split = f"{jax.device_count()} devices" if jax.device_count() > 1 else "1 device"

    def ways(one):
        return {
            "vmap of scan, matrix product": side_by_side(partial(one, scanned, tanh_neurons_by_matrix)),
            "vmap of scan": side_by_side(partial(one, scanned, tanh_neurons)),
            "map of scan, 5 at once": in_turn(partial(one, scanned, tanh_neurons), 5),
            "map of scan by stop": in_turn(partial(one, scanned_by_stop, tanh_neurons)),
            "map of scan by stop, matrix product": in_turn(
                partial(one, scanned_by_stop, tanh_neurons_by_matrix)
            ),
        }

    return {
        task: {f"{name}, {split}": on_devices(way, population, given) for name, way in ways(one).items()}
        for task, one, given in (
            ("population", simulate, drive),
            ("population_fit", fit_output, (*drive, target)),
        )
    }
