"""Constraints of the catalogue as arrays."""

import numpy

from . import _souple

# The numbers of C++'s Params, in their order.
_PARAMETERS = {
    "distance": ("rest_length",),
    "dihedral_bending": ("scale", "rest_sine", "rest_cosine", "k1", "k2", "k3"),
    "isometric_bending": ("k1", "k2", "k3"),
    "triangle_membrane": ("b00", "b01", "b10", "b11"),
    "tet_volume": ("rest_volume", "rest_size"),
    "neo_hookean": ("rest_inverse",),
    "rope_bending": ("rest_length",),
    "particle_contact": ("distance",),
    "attachment": ("target",),
    "ball_joint": ("weight",),
    "cone_limit": ("max_angle",),
    "twist_limit": ("rest_sine", "rest_cosine", "max_angle"),
    "tether": ("max_length",),
}


def constraint_kinds():
    """The catalogue: {kind: (particles, rows, numbers of parameters, numbers of compliance, names of parameters)}."""
    return {kind: (*sizes[:4], _PARAMETERS[kind]) for kind, sizes in _souple._constraint_kinds().items()}


def _rest_parameters(kind, rest, arity, has_rest):
    rest = numpy.asarray(rest, dtype=float)
    if rest.ndim != 3 or rest.shape[1:] != (arity, 3):
        raise _souple.Error(f"SetProjector: expected rest positions of shape (n, {arity}, 3), found shape {rest.shape}")
    if kind == "distance":
        return numpy.linalg.norm(rest[:, 0] - rest[:, 1], axis=1)[:, None]
    if not has_rest:
        raise _souple.Error(f"SetProjector: {kind} has no rest shape; give its parameters: {', '.join(_PARAMETERS[kind])}")
    return numpy.asarray(_souple._constraint_parameters(kind, rest.reshape(-1, 3))).reshape(len(rest), -1)


def _named_parameters(kind, parameters, count):
    names = _PARAMETERS[kind]
    if set(parameters) != set(names):
        raise _souple.Error(f"SetProjector: {kind} has the parameters {', '.join(names)}, found {', '.join(parameters)}")
    columns = [_columns(_numbers(parameters[name], name), count, len(names) == 1) for name in names]
    return numpy.concatenate(columns, axis=1)


def _columns(values, count, alone):
    """(count, numbers): of one number, one for each constraint, one row for all, or a row for each."""
    if values.ndim == 0:
        return numpy.full((count, 1), values)
    if values.ndim == 1:
        one_row = alone and len(values) != count
        return numpy.broadcast_to(values, (count, len(values))) if one_row else values.reshape(-1, 1)
    return values.reshape(len(values), -1)


def _numbers(values, what):
    array = numpy.asarray(values)
    if array.dtype.kind not in "fiub":
        raise _souple.Error(f"SetProjector: expected numbers of {what}, found type {array.dtype}")
    return array


def SetProjector(kind, particles, parameters=None, *, rest=None, compliance=0, damping_time=0,
                 stiffness=1) -> _souple._ConstraintArrays:
    """Many constraints of one kind of the catalogue, for World.add_projector. They run at C++'s speed.

    kind: "distance", "neo_hookean", ...; see constraint_kinds().
    particles: (n, particles of the kind), indices that World.particles gives.
    parameters: {name: one number, or one for each constraint}, or an array (n, numbers) in C++'s order.
    rest: in place of parameters: positions at rest, (n, particles, 3) [m].
    compliance: alpha [(unit of C)^2 / J], one number or one for each constraint; damping_time [s]; stiffness: PBD mode only.
    """
    kinds = _souple._constraint_kinds()
    if kind not in kinds:
        raise _souple.Error(f"SetProjector: no kind of constraints is called {kind!r}; known: {', '.join(kinds)}")
    arity, _, count, compliances, has_rest = kinds[kind]
    indices = numpy.asarray(particles)
    if indices.ndim != 2 or indices.shape[1] != arity or indices.dtype.kind not in "iu":
        raise _souple.Error(f"SetProjector: expected particles as whole numbers of shape (n, {arity}) for {kind}, "
                            f"found {indices.dtype} of shape {indices.shape}")
    if indices.size and (indices.min() < 0 or indices.max() >= 2**32):
        raise _souple.Error("SetProjector: a particle's index is negative or too large")
    if (parameters is None) == (rest is None):
        raise _souple.Error("SetProjector: expected parameters, or rest positions in their place")
    if rest is not None:
        parameters = _rest_parameters(kind, rest, arity, has_rest)
    elif isinstance(parameters, dict):
        parameters = _named_parameters(kind, parameters, len(indices))
    alpha = _numbers(compliance, "compliance")
    if compliances > 1 and alpha.ndim == 0:
        diagonal = {row * (row + 3) // 2 for row in range(compliances)}  # of a packed lower triangle: 0, 2, 5, ...
        alpha = numpy.array([alpha if k in diagonal else 0 for k in range(compliances)])
    return _souple._constraint_arrays(kind, numpy.ascontiguousarray(indices, dtype="u4"), _numbers(parameters, "parameters"),
                                      alpha, _numbers(damping_time, "damping_time"), _numbers(stiffness, "stiffness"))
