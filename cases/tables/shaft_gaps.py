"""Days on which gaps between freeze pipes close, by a program that shares nothing with frazil: the source of shaft-groundwater.csv and
of the zigzags of 54 mm pipes in shaft-closures.csv.

Linear finite elements with lumped heat on triangles fitted to the pipes (gmsh), enthalpy by backward Euler and Newton with direct
solves (scipy). Water follows Darcy's law through ground that conducts it in proportion to what is unfrozen; its pressure is solved
before each step. Heat that water carries is central, with as much more exchange as keeps a node from being outweighed, which
cells near the pipes never need. Without water a wedge of half a pipe spacing, with it the half of the plan beside the x axis.

    pip install numpy scipy gmsh
    python shaft_gaps.py --layout three --soil sand --cell 0.005 --days 12
    python shaft_gaps.py --pipes 26 --velocity 0.2 --cell 0.04 --step 0.05 --days 60

A gap counts as closed when nodes that are frozen through join its pipes ("closed"); when nodes of which half the latent heat is gone
do ("half") says how much the cells matter.
"""

import argparse
import math

import gmsh
import numpy as np
import scipy.sparse as sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

DAY = 86400.0
OUTER_RADIUS, CENTRE_RADIUS = 15.0, 0.05
RING, INNER_RING, PIPE_RADIUS = 5.0, 4.2, 0.054
PIPE_TEMPERATURE, START_TEMPERATURE = -20.0, 15.0
WATER_HEAT = 1000.0 * 4190.0
# What frozen ground keeps of its hydraulic conductivity.
LEAST = 1e-6
# density, conductivities unfrozen and frozen, heat capacities unfrozen and frozen, latent heat
SOILS = {
    "sand": (2090.0, 1.86, 2.56, 1465.1, 1088.4, 52875.8),
    "clay": (2050.0, 1.51, 2.05, 1548.8, 1172.1, 530718.0),
    "clay10": (2050.0, 1.51, 2.05, 1548.8, 1172.1, 53071.8),
}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--layout", choices=["single", "three", "four"], default="single")
    parser.add_argument("--soil", choices=SOILS, default="sand")
    parser.add_argument("--pipes", type=int, default=26, help="pipes on the ring of 5 m")
    parser.add_argument("--velocity", type=float, help="of the groundwater far away, along x, m/day; only --layout single")
    parser.add_argument("--mean", choices=["arithmetic", "harmonic"], default="arithmetic", help="of the hydraulic conductivity of two nodes")
    parser.add_argument("--cell", type=float, required=True, help="where gaps close, m; half of it at pipes")
    parser.add_argument("--slope", type=float, default=0.08, help="by which cells grow with the distance from there")
    parser.add_argument("--step", type=float, default=0.02, help="longest time step, days")
    parser.add_argument("--days", type=float, required=True, help="duration")
    return parser.parse_args()


def polar(radius, angle):
    return np.array([radius * math.cos(angle), radius * math.sin(angle)])


def to_segment(point, start, end):
    along = end - start
    part = np.clip((point - start) @ along / (along @ along), 0.0, 1.0)
    return np.linalg.norm(point - start - part * along)


def mesh(sector, pipes, size):
    """Nodes and triangles of a sector without its pipes."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    shapes = gmsh.model.occ
    far, near = [[shapes.addPoint(*polar(r, a), 0) for a in (0.0, sector)] for r in (OUTER_RADIUS, CENTRE_RADIUS)]
    centre = shapes.addPoint(0, 0, 0)
    if sector > 3.0:
        middle = shapes.addPoint(0, OUTER_RADIUS, 0)
        sides = [(far[0], middle), (middle, far[1])]
        lines = [shapes.addCircleArc(a, centre, b) for a, b in sides] + [shapes.addLine(far[1], far[0])]
    else:
        lines = [
            shapes.addLine(near[0], far[0]),
            shapes.addCircleArc(far[0], centre, far[1]),
            shapes.addLine(far[1], near[1]),
            shapes.addCircleArc(near[1], centre, near[0]),
        ]
    plan = shapes.addPlaneSurface([shapes.addCurveLoop(lines)])
    shapes.cut([(2, plan)], [(2, shapes.addDisk(*at, 0, PIPE_RADIUS, PIPE_RADIUS)) for at in pipes])
    shapes.synchronize()
    gmsh.model.mesh.setSizeCallback(lambda _dim, _tag, x, y, _z, _size: size(np.array([x, y])))
    for source in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
        gmsh.option.setNumber("Mesh.MeshSize" + source, 0)
    gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    triangles = gmsh.model.mesh.getElements(2)[2][0].reshape(-1, 3)
    gmsh.finalize()
    used = np.unique(triangles)
    place = {int(tag): i for i, tag in enumerate(tags)}
    nodes = coordinates.reshape(-1, 3)[[place[int(tag)] for tag in used], :2]
    return nodes, np.searchsorted(used, triangles)


class Plan:
    """Elements of a mesh: the area of each node, and edges with what they conduct at unit conductivity."""

    def __init__(self, nodes, triangles):
        corners = nodes[triangles]
        opposite = np.roll(corners, -1, 1) - np.roll(corners, 1, 1)
        one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
        local = np.einsum("tid,tjd->tij", opposite, opposite) / (4.0 * area)[:, None, None]
        rows, columns = np.repeat(triangles, 3, 1).ravel(), np.tile(triangles, (1, 3)).ravel()
        self.count = len(nodes)
        whole = sparse.csr_matrix((local.ravel(), (rows, columns)), shape=(self.count, self.count))
        above = sparse.triu(whole, 1).tocoo()
        self.start, self.end, self.conductance = above.row, above.col, -above.data
        self.area = np.bincount(triangles.ravel(), np.repeat(area / 3.0, 3), self.count)

    def exchange(self, forth, back):
        """The matrix of sums over edges of a weight times the difference to the other end; one weight as seen from each end."""
        places = (np.r_[self.start, self.end], np.r_[self.end, self.start])
        off = sparse.coo_matrix((np.r_[forth, back], places), shape=(self.count, self.count)).tocsr()
        return (off - sparse.diags(np.asarray(off.sum(1)).ravel())).tocsr()


def solve(matrix, right):
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}).solve(right)


def main():
    args = arguments()
    density, warm, cold, warm_heat, cold_heat, latent = SOILS[args.soil]
    latent *= density
    flows = args.velocity is not None
    if flows and (args.layout != "single" or args.pipes % 2):
        raise SystemExit("--velocity: only with --layout single and an even number of --pipes, of which half is a mirror of the other")
    spacing = 2.0 * math.pi / args.pipes
    sector = math.pi if flows else 0.5 * spacing
    inner = {"single": [], "three": [0.5 * spacing], "four": [0.25 * spacing]}[args.layout]
    ring = [polar(RING, k * spacing) for k in range(int(sector / spacing + 1e-9) + 1)]
    pipes = ring + [polar(INNER_RING, angle) for angle in inner]
    # Half of each gap lies in the wedge, but for zigzags.
    of_wedge = [(pipes[0], polar(RING, 0.5 * spacing))]
    for at, turn in zip(pipes[1:], inner):
        of_wedge += [(pipes[0], at)] + [(at, polar(INNER_RING, plane)) for plane in (0.0, 0.5 * spacing) if plane != turn]

    def size(at):
        radius = np.linalg.norm(at)
        if flows:
            from_gap = max(abs(radius - RING) - 0.35, 0.0)
        else:
            from_gap = max(min(to_segment(at, *gap) for gap in of_wedge) - 0.08, 0.0)
        from_walls = max(INNER_RING - 0.2 - radius, radius - RING - 0.2, 0.0)
        pipe = max(min(np.linalg.norm(at - other) for other in pipes) - PIPE_RADIUS, 0.0)
        wall = math.inf if flows else max(2.0 * args.cell, 0.02) + 0.15 * from_walls
        return min(args.cell + args.slope * from_gap, wall, 0.5 * args.cell + 0.2 * pipe, 0.35)

    nodes, triangles = mesh(sector, pipes, size)
    plan = Plan(nodes, triangles)
    radius, angle = np.hypot(*nodes.T), np.arctan2(np.maximum(nodes[:, 1], 0.0), nodes[:, 0])
    outer = radius > OUTER_RADIUS * (1.0 - 1e-6)
    of_pipe = [np.hypot(*(nodes - at).T) < PIPE_RADIUS * (1.0 + 1e-3) for at in pipes]
    cooled = np.any(of_pipe, axis=0)
    free, wet = np.flatnonzero(~(outer | cooled)), np.flatnonzero(~outer)

    def by_phase(heat, frozen, open_ground):
        return np.where(heat < 0.0, frozen, np.where(heat > latent, open_ground, 0.0))

    frozen_heat, open_heat = density * cold_heat, density * warm_heat

    def temperature(heat):
        return by_phase(heat, heat / frozen_heat, (heat - latent) / open_heat)

    def temperature_slope(heat):
        return by_phase(heat, 1.0 / frozen_heat, 1.0 / open_heat)

    def potential(heat):
        return by_phase(heat, cold * heat / frozen_heat, warm * (heat - latent) / open_heat)

    def potential_slope(heat):
        return by_phase(heat, cold / frozen_heat, warm / open_heat)

    heat = np.full(plan.count, latent + START_TEMPERATURE * open_heat)
    heat[cooled] = PIPE_TEMPERATURE * frozen_heat
    conduction = plan.exchange(-plan.conductance, -plan.conductance)
    pressure = -(args.velocity or 0.0) / DAY * nodes[:, 0]

    def water(heat):
        """Water along each edge, from its start to its end; pressures over the hydraulic conductivity of open ground."""
        open_part = np.clip(heat / latent, LEAST, 1.0)
        one, two = open_part[plan.start], open_part[plan.end]
        mean = 0.5 * (one + two) if args.mean == "arithmetic" else 2.0 * one * two / (one + two)
        matrix = plan.exchange(-plan.conductance * mean, -plan.conductance * mean)
        right = -matrix[wet][:, np.flatnonzero(outer)] @ pressure[outer]
        pressure[wet] = solve(matrix[wet][:, wet], right)
        return plan.conductance * mean * (pressure[plan.start] - pressure[plan.end])

    def carried(heat):
        """The matrix of what water carries away from nodes, by their temperatures."""
        along = water(heat)
        both_warm = (heat[plan.start] > 0.0) & (heat[plan.end] > 0.0)
        least = np.maximum(0.0, 0.5 * np.abs(along) * WATER_HEAT - np.abs(plan.conductance) * np.where(both_warm, warm, cold))
        return plan.exchange(0.5 * along * WATER_HEAT - least, -0.5 * along * WATER_HEAT - least)

    # Gaps between two pipes, with the nodes and edges beside them, and places that freeze.
    gaps = []

    def gap(name, one, two, beside):
        inside = np.flatnonzero(beside | of_pipe[one] | of_pipe[two])
        place = np.full(plan.count, -1)
        place[inside] = np.arange(len(inside))
        edges = (place[plan.start] >= 0) & (place[plan.end] >= 0)
        ends = [place[np.flatnonzero(of_pipe[k])[0]] for k in (one, two)]
        gaps.append((name, *ends, inside, place[plan.start[edges]], place[plan.end[edges]]))

    if flows:
        for k in range(len(ring) - 1):
            beside = (angle >= (k - 1e-9) * spacing) & (angle <= (k + 1 + 1e-9) * spacing) & (np.abs(radius - RING) < 1.5)
            gap(f"{math.degrees((k + 0.5) * spacing):.2f} degrees", k, k + 1, beside)
    elif inner:
        gap("zigzag", 0, 1, np.full(plan.count, True))
    planes = {"main": np.abs(nodes[:, 1]) < 1e-9, "interface": np.abs(angle - 0.5 * spacing) < 1e-9}
    circles = [] if flows else [("circle_outer", "interface", RING)]
    circles += [("circle_inner_interface", "interface", INNER_RING)] if args.layout == "four" else []
    circles += [("circle_inner_main", "main", INNER_RING)] if inner else []
    places = []
    for name, plane, at in circles:
        on = np.flatnonzero(planes[plane])
        places.append((name, on[[np.argmin(np.abs(radius[on] - at))]]))
    if args.layout == "single" and not flows:
        places.append(("touch", np.flatnonzero(planes["interface"] & (np.abs(radius - RING) < 0.5))))

    def joined(frozen, gap):
        _, one, two, nodes_there, starts, ends = gap
        frozen = frozen[nodes_there]
        both = frozen[starts] & frozen[ends]
        links = sparse.coo_matrix((np.ones(both.sum()), (starts[both], ends[both])), shape=(len(frozen), len(frozen)))
        body = connected_components(links, directed=False)[1]
        return body[one] == body[two]

    found = {name: [None, None] for name, *_ in gaps + places}

    def look(day):
        for k, limit in enumerate((0.5 * latent, 0.0)):
            frozen = heat <= limit
            for one in gaps:
                days = found[one[0]]
                if days[k] is None and (k == 0 or days[0] is not None) and joined(frozen, one):
                    days[k] = day
            for name, nodes_there in places:
                if found[name][k] is None and frozen[nodes_there].any():
                    found[name][k] = day

    print(f"# {vars(args)}, {plan.count} nodes", flush=True)
    now, step = 0.0, 1e-3 * DAY
    conducts, area = conduction[free], plan.area[free]
    while now < args.days * DAY and any(days[1] is None for days in found.values()):
        step = min(step, args.step * DAY)
        carries = carried(heat)[free] if args.velocity else None
        new = heat.copy()
        for iteration in range(30):
            rest = area * (new[free] - heat[free]) / step + conducts @ potential(new)
            slope = conducts[:, free] @ sparse.diags(potential_slope(new[free])) + sparse.diags(area / step)
            if carries is not None:
                rest += carries @ temperature(new)
                slope = slope + carries[:, free] @ sparse.diags(temperature_slope(new[free]))
            if np.max(np.abs(rest) * step / area) < 1e-7 * latent:
                break
            new[free] -= solve(slope, rest)
        else:
            step *= 0.5
            continue
        heat, now = new, now + step
        look(now / DAY)
        step *= 1.2 if iteration <= 8 else 0.8
    print("gap,half_day,closed_day")
    for name, days in found.items():
        print(f"{name},{','.join('' if day is None else f'{day:.3f}' for day in days)}")


if __name__ == "__main__":
    main()
