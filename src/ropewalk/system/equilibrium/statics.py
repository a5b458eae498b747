"""Potential energy of a structure at rest with what stands on it, as `solve/minimum.py` wants it.

A contact adds the kink under it (`contacts.py`), a function of q = |d|^2/2 and of the squares of lengths of its links
without it, lambda = l^2/2, and what it stores along the line. Its derivatives by q are S, by lambda T/l; those of S and
T/l follow from S = S(T), with T the mean of h T/l of the links, kinks included.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.sparse as sparse

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import lean, lean_inner
from ropewalk.solve.symmetric import Way
from ropewalk.system.contact.contact_point import locate_point
from ropewalk.system.contact.contact_record import BODY, ON
from ropewalk.system.contact.contacts import add_contact_forces, bend
from ropewalk.system.contact.yielding import axial_stiffness, stored_beside
from ropewalk.system.elements.air import damping_by_wind
from ropewalk.system.elements.cables import add_internal_forces, energy_of, find_strains, stretch_all
from ropewalk.system.elements.compliance import ARC, PART, SHORT_ARC, SMOOTH, compliances
from ropewalk.system.elements.link_forms import LinkForms, scaled
from ropewalk.system.elements.saddles import add_saddle_forces, stored_in_saddles
from ropewalk.system.elements.sheaves import (
    LITTLE,
    SLIPS,
    add_sheave_forces,
    pass_nodes_entry,
    slip,
    stored_at,
    stretch_over,
)
from ropewalk.system.elements.sheaves_at_rest import (
    damping_of,
    gravitational,
    neighbours_of,
    part_until_passing,
    push_over,
    stiffness_of,
)
from ropewalk.system.elements.spline import WIDTH
from ropewalk.system.elements.structure import WORKS, Buffers, Structure
from ropewalk.system.elements.surfaces import add_surface_forces, distribute_forces, stored_in
from ropewalk.system.elements.ties import add_tie_forces, stored_in_ties
from ropewalk.system.equilibrium.named_part import named_part
from ropewalk.system.equilibrium.softening import stiffened
from ropewalk.system.loads.loaded_structure import LoadedStructure


@lean_inner
def _stretch(structure, buffers, contacts, state, table, out, how):
    """Strains of all links with the kinks under what stands on them."""
    runs, r = structure.runs, state.r
    stretch_all(structure, buffers, r)
    find_strains(structure, buffers)
    stretch_over(structure.sheaves, runs, buffers, r)
    for k in range(contacts.size):
        if contacts[k].state == ON:
            has_body = contacts[k].kind == BODY
            contacts[k].axial_stiffness = axial_stiffness(structure, contacts, k, has_body)
            locate_point(structure, contacts, k, r, has_body)
    bend(structure, buffers, contacts, state, table, out)
    slip(structure.sheaves, runs, r, how)


@lean
def _stored(structure, buffers, contacts, state, table, out, how):
    """Energy stored in all runs with their kinks, J."""
    _stretch(structure, buffers, contacts, state, table, out, how)
    total = energy_of(structure, buffers, state.r) + stored_in(structure.surfaces, state.r)
    total += stored_at(structure.sheaves, structure.runs, state.r) + stored_in_ties(structure.ties, state.r)
    total += stored_in_saddles(structure.saddles, state.r)
    for k in range(contacts.size):
        if contacts[k].state == ON:
            total += stored_beside(contacts, k, state.r.shape[0])
    return total


@lean
def _forces(structure, buffers, contacts, state, table, out, how, given, firm):
    """Add the forces of all runs and contacts to `room.force`.

    Args:
        given: first coordinate of given forces which press by the stiffness of their own kink.
        firm: (contact,) N/m, overwritten: stiffness under the tension that each kink makes by itself.
    """
    _stretch(structure, buffers, contacts, state, table, out, how)
    for k in range(contacts.size):
        firm[k] = contacts[k].moving
    add_internal_forces(structure, buffers, state.r, 0.0)
    add_contact_forces(structure, buffers, contacts, state, table, out)
    add_surface_forces(structure.surfaces, state.r, buffers.force)
    add_tie_forces(structure.ties, state.r, buffers.force)
    add_saddle_forces(structure.saddles, state.r, buffers.force)
    add_sheave_forces(structure.sheaves, structure.runs, buffers, state.r, 0.0)
    for k in range(contacts.size):
        if contacts[k].state == ON and contacts[k].first >= given:
            for a in range(state.r.shape[0]):
                more = (firm[k] - contacts[k].moving) * contacts[k].d[a]
                contacts[k].N[a] += more
                for j in range(min(WIDTH, structure.runs.links[contacts[k].run] + 1)):
                    buffers.force[a, contacts[k].near + j] += contacts[k].weight[j] * more
    distribute_forces(structure.surfaces, buffers.force)


class SystemPotential:
    """Potential energy as a function of a shape: places of all nodes (axis, node), then coordinates of loads.

    Args:
        structure: what is at rest.
        loaded: what stands on it.
        size: m, of the structure.
        within: whether only what stays in the plane needs to be stable.
        part: of the compliance within a run that contacts at its ends have, see `compliance.py`.
        how: lines slip over sheaves, see `sheaves.py`.
    """

    is_symmetric = True

    def __init__(
        self, structure: Structure, loaded: LoadedStructure, size: float, *, within: bool = False, part: float = PART,
        how: int = SLIPS,
    ) -> None:  # fmt: skip
        self.structure, self.loaded, self.size, self.within, self.how = structure, loaded, size, within, how
        self.axes, n = loaded.rest.shape
        self.buffers, self.table, self._out = Buffers.of(structure, self.axes), compliances(part=part), np.zeros(4)
        self.blown = np.zeros((self.axes, n))  # N, of the wind
        self._stiff = np.zeros(0), sparse.csc_matrix((0, 0))  # a shape and the stiffness found last
        self._softer = np.zeros(n)  # N, by which links are softer than by their laws
        restrained = structure.restraints
        moves = np.ones(n, dtype=np.bool_)
        moves[restrained.node] = False
        if structure.surfaces is not None:  # whose ways are where they are
            moves[structure.surfaces.node] = False
        whole = np.flatnonzero(np.concatenate([moves & structure.on_runs, *([moves] * (self.axes - 1))]))
        columns = [(whole, np.arange(whole.size), np.ones(whole.size))]
        count = whole.size
        for e in range(restrained.mass.size):
            nodes = restrained.members(e)
            values, ways = np.linalg.eigh(restrained.free[e])
            for way in ways.T[values > 0.5]:
                at = (nodes[None, :] + n * np.arange(self.axes)[:, None]).ravel()
                columns.append((at, np.full(at.size, count), np.repeat(way, nodes.size)))
                count += 1
        row, column, value = (np.concatenate(parts) for parts in zip(*columns, strict=True))
        self._nodes_free = sparse.csc_matrix((value, (row, column)), shape=(self.axes * n, count))
        if structure.surfaces is not None:
            laid = sparse.block_diag([structure.surfaces.shares(n)] * self.axes)
            self._nodes_free = (self._nodes_free + laid @ self._nodes_free).tocsc()
        if structure.is_linearised and structure.saddles is not None:
            self._nodes_free = structure.saddles.sticking(self._nodes_free, structure.about.shape[0])
        self.divide()
        self.arrange()

    def divide(self) -> None:
        """Take note of which nodes are those of which run."""
        self._forms = LinkForms.of(self.structure, self.axes, self.loaded.weight.size)

    def arrange(self) -> None:
        """Take note of what stands where."""
        bodies = sparse.identity(self.loaded.weight.size, format="csc")[:, self.loaded.moves]
        self.free = sparse.block_diag([self._nodes_free, bodies], format="csc")
        self._ways = self._beside_lines()

    def stick(self, shape: Array) -> None:
        """Let friction hold what lies on saddles in a shape, and lines at sheaves, as it does in small motion."""
        self.how = LITTLE
        if self.structure.saddles is not None:
            r = shape[: self.loaded.rest.size].reshape(self.loaded.rest.shape)
            self._nodes_free = self.structure.saddles.sticking(self._nodes_free, r)
            self.arrange()

    def remember(self, lag: Array, softer: Array, *, slips: bool) -> None:
        """Let links be let off, (2, node) N, and be softer, (node,) N; and lines slip over sheaves that rub, or not."""
        self.buffers.lag[:], self._softer[:], self.how = lag, softer, SLIPS if slips else LITTLE

    def put(self, shape: Array) -> tuple[Array, Array]:
        """Put everything into a shape; gives places of the nodes (axis, node) and coordinates of loads."""
        state = self.loaded.state
        state.r[:], state.u[:] = shape[: state.r.size].reshape(state.r.shape), shape[state.r.size :]
        return state.r, state.u

    def taken(self) -> Array:
        """The shape that everything is in."""
        return np.concatenate([self.loaded.state.r.ravel(), self.loaded.state.u])

    def stored(self, shape: Array) -> float:
        """Energy stored in the runs with their kinks, J."""
        self.put(shape)
        return float(_stored(*self._arguments()))

    def energy(self, shape: Array) -> float:
        """Potential energy, J."""
        restrained, total = self.structure.restraints, self.stored(shape)
        r, u = self.put(shape)
        if self.structure.sheaves is not None:
            total += gravitational(self.structure.sheaves, self.structure.runs, r)
        total -= float(((self.structure.nodes.force + self.blown) * r).sum())
        for e in range(restrained.mass.size):
            here = r[:, restrained.node[restrained.first[e]]]
            away = here - self.place_of(e)
            total += 0.5 * float(away @ restrained.stiffness[e] @ away) - float(restrained.force[e] @ here)
        return total + self.loaded.energy(u)

    def place_of(self, e: int) -> Array:
        """Where a restraint stands, or its springs are without force, m."""
        return self.structure.restraints.place_at(e, float(self.loaded.state.t[0]))

    def _arguments(self) -> tuple[object, ...]:
        own, loaded = self.structure.for_kernels, self.loaded
        buffers = self.buffers.for_kernels(self.structure)
        return own, buffers, loaded.contacts, loaded.state, self.table, self._out, self.how

    def _look(self, shape: Array) -> tuple[Array, Array]:
        """Find all forces in a shape, see `put`."""
        found = self.put(shape)
        self.buffers.force[:] = self.structure.nodes.force + self.blown
        loaded = self.loaded
        given = loaded.own if loaded.as_moving else loaded.weight.size
        _forces(*self._arguments(), given, loaded.firm)
        return found

    def forces(self, shape: Array) -> Array:
        """Forces on all nodes (axis, node) and then on coordinates, N, those of springs of supports included."""
        r, u = self._look(shape)
        restrained, out = self.structure.restraints, self.buffers.force.copy()
        for e in range(restrained.mass.size):
            node = restrained.node[restrained.first[e]]
            out[:, node] += restrained.force[e] + restrained.stiffness[e] @ (self.place_of(e) - r[:, node])
        return np.concatenate([out.ravel(), self.loaded.forces(u)])

    def out_of_balance(self, shape: Array) -> Array:
        return np.asarray(self.free.T @ self.forces(shape))

    def stiffness(self, shape: Array, *, convex: bool = False) -> sparse.csc_matrix:
        """Second derivatives of the energy, (unknown, unknown) N/m; `convex`: without the thrust of links."""
        runs, n, axes = self.structure.runs, self.structure.nodes.mass.size, self.axes
        r, u = self._look(shape)
        tension, strain, length = self.buffers.tension.copy(), self.buffers.strain.copy(), self.buffers.length.copy()
        if self.structure.is_linearised:
            tension[:], strain[:] = self.structure.about.links["tension"], self.structure.about.links["strain"]
        h, is_link = np.ones(n), np.zeros(n, dtype=np.bool_)
        slope, EI, smooth, bed = np.zeros((4, n))
        for s, (first, links) in enumerate(zip(runs.first, runs.links, strict=True)):
            part = slice(first, first + links)
            h[part], is_link[part] = runs.h[s], True
            if runs.law[s, 0] == law.RIGID:  # what its tension changes by is an unknown of its own
                slope[part] = runs.h[s] * tension[part] / length[part]
            else:
                slope[part] = law.tangents(runs.law[s], strain[part]) - self._softer[part]
            part, cube = slice(first, first + links + 1), runs.h[s] ** 3
            segments = self.structure.segments
            EI[part] = (runs.bending[s] if segments is None else segments.bending[part]) / cube
            smooth[part] = (runs.bending[s] if segments is None else segments.smooth[part]) / cube
            bed[part] = (runs.bed[s] if segments is None else segments.bed[part]) * runs.h[s]
            bed[[first, first + links]] *= 0.5
            tension[first + links] = 0.0
            h[first + links] = runs.h[s]
        length[~is_link] = 1.0
        q = np.maximum(tension, 0.0) / length if convex else tension / length
        rise = (slope / h - q) / length**2  # change of T/l with l^2/2
        arced = q * self._forms.arcs
        arcs = 2.0 * ARC * (arced + np.concatenate([[0.0], arced[:-1]]))
        by_forms = [q, arcs + EI * self._forms.weight, SMOOTH * smooth + 2.0 * SHORT_ARC * arced]
        rows = self.rows(r)
        K = self._forms.across.of(np.concatenate([*(by_forms * axes), bed])) + rows.T @ scaled(rows, rise)
        if self.loaded.on.size:
            K = K + self._kinks(rows, rise)
        K = K + self._of_groups("stiffness", r, u.size) + self._of_restraints("stiffness")
        if u.size:
            K = K + sparse.block_diag([sparse.csr_matrix((r.size, r.size)), self.loaded.stiffness(u)])
        K = (self.free.T @ K @ self.free).tocsc()
        K.eliminate_zeros()
        self._stiff = shape, K
        return K

    def convex(self, shape: Array) -> sparse.csc_matrix:
        return self.stiffness(shape, convex=True)

    def _of_restraints(self, what: str) -> sparse.csr_matrix:
        """Springs or dampers of supports, (place, place)."""
        restrained, n = self.structure.restraints, self.structure.nodes.mass.size
        values = getattr(restrained, what)
        acts = np.flatnonzero(values.any(axis=(1, 2)))
        at = restrained.node[restrained.first[acts]][:, None] + n * np.arange(self.axes)
        row, column = np.repeat(at, self.axes, axis=1), np.tile(at, self.axes)
        entries = values[acts].ravel(), (row.ravel(), column.ravel())
        return sparse.csr_matrix(entries, shape=(self.free.shape[0],) * 2)

    def _of_groups(self, what: str, r: Array, more: int) -> sparse.csc_matrix:
        """Second derivatives of cells, ties and pieces at sheaves, or their dampers; see `rows`."""
        structure, runs = self.structure, self.structure.runs
        found = [getattr(g, what)(r) for g in (structure.surfaces, structure.ties, structure.saddles) if g]
        if (over := structure.sheaves) is not None:
            is_stiffness = what == "stiffness"
            found.append(stiffness_of(over, runs, r, self.how) if is_stiffness else damping_of(over, runs, r))
        if not found:
            return sparse.csc_matrix((r.size + more, r.size + more))
        total = sum(found, start=sparse.csc_matrix((r.size, r.size)))
        return sparse.block_diag([total, sparse.csc_matrix((more, more))], format="csc")

    def rows(self, r: Array) -> sparse.csr_matrix:
        """Change of l^2/2 of all links, without kinks, with the shape (node, place), m; linearised: at rest."""
        D = self.buffers.bent
        if self.structure.is_linearised:
            r, D = self.structure.about.shape
        one = self._forms.one
        by_axis = [c for a in range(self.axes) for c in (one @ r[a], D[a], one @ D[a])]
        return self._forms.lengthened.of(np.concatenate(by_axis))

    def _beside_lines(self) -> sparse.csr_matrix:
        """Change of where contacts on their lines are beside these, m, and of the derivatives of their splines by s.

        Of each axis all contacts, one after the other, with the shape: (2 axis contact, place).
        """
        loaded, axes, n = self.loaded, self.axes, self.structure.nodes.mass.size
        on, count = loaded.on, loaded.on.size * self.axes
        if not count:
            return sparse.csr_matrix((0, axes * n + loaded.weight.size))
        nodes = [sparse.block_diag([part[on]] * axes) for part in (-loaded.shares(n), loaded.slopes(n))]
        at = (loaded.contacts["first"][on] + np.arange(axes)[:, None]).ravel()
        own = sparse.csr_matrix((np.ones(count), (np.arange(count), at)), shape=(2 * count, loaded.weight.size))
        return sparse.hstack([sparse.vstack(nodes), own], format="csr")

    def _summed(self, factors: Array) -> sparse.csr_matrix:
        """Sums over what `_beside_lines` has of each contact, by factors (contact, one for each)."""
        count, each = factors.shape
        columns = np.arange(count)[:, None] + count * np.arange(each)
        return sparse.csr_matrix((factors.ravel(), columns.ravel(), each * np.arange(count + 1)))

    def stretched(self) -> sparse.csr_matrix:
        """Change of |d|^2/2 of all contacts on their lines with the shape, (contact, place) m."""
        contacts = self.loaded.contacts[self.loaded.on]
        d = contacts["d"][:, : self.axes]
        turns = -d * (contacts["axial"] / contacts["spread"])[:, None]
        return self._summed(np.hstack([d, turns])) @ self._ways

    def borne(self) -> sparse.csr_matrix:
        """Change of T of the contacts on their lines with T/l of links, and of l^2/2 with K/h, (contact, link) m."""
        contacts, on, n = self.loaded.contacts, self.loaded.on, self.structure.nodes.mass.size
        own = self.structure.runs.h[contacts["run"][on]]
        entries = (own[:, None] * contacts["part"][on]).ravel(), (np.repeat(np.arange(on.size), 3),
                                                                  contacts["link"][on].ravel())  # fmt: skip
        return sparse.coo_matrix(entries, shape=(on.size, n)).tocsr()

    def _kinks(self, rows: sparse.csr_matrix, rise: Array) -> sparse.csc_matrix:
        """What contacts add to the second derivatives, (place, place) N/m."""
        contacts, on = self.loaded.contacts, self.loaded.on
        beside = self._beside()
        if self.structure.is_linearised:  # kinks and tensions do not know of each other
            return beside
        first, second, d = (contacts[key][on] for key in ("by_tension", "curve", "d"))
        borne, stretched = self.borne(), self.stretched().T
        felt = sparse.diags(rise) @ borne.T
        both, C, D = (borne @ felt).toarray(), np.diag(0.5 * (d**2).sum(axis=1) * second), np.diag(first)
        X = np.linalg.inv(np.eye(on.size) - both @ C)
        pulled = rows.T @ felt
        mixed = pulled @ sparse.csr_matrix(X.T @ D) @ stretched.T
        K = pulled @ sparse.csr_matrix(C @ X) @ pulled.T + mixed + mixed.T
        K = K + stretched @ sparse.csr_matrix(D @ X @ both @ D) @ stretched.T
        return (K + beside).tocsc()

    def _beside(self) -> sparse.csc_matrix:
        """What contacts add at the tensions that there are, (place, place) N/m.

        With x from p to what touches, the derivative p' of p, t = p'/|p'| and e = x . t, it is S |d|^2/2 + S_a e^2/2 =
        S |x|^2/2 + (S_a - S) e^2/2, and de = t . dx + d . dp'/|p'|.
        """
        contacts, one = self.loaded.contacts[self.loaded.on], np.eye(self.axes)
        S, axial, long = contacts["moving"], contacts["axial"][:, None, None], contacts["spread"][:, None, None]
        away = (contacts["apart"] == 1) & (contacts["clear"] == 1)  # and follows the line along it
        along = ~away & (contacts["axial_stiffness"] > 0.0)
        more = np.where(along, contacts["axial_stiffness"] - S, 0.0)[:, None, None]
        t, d = (contacts[key][:, : self.axes] for key in ("tangent", "d"))
        tt, td = t[:, :, None] * t[:, None, :], t[:, :, None] * d[:, None, :]
        across, dd = one - tt, d[:, :, None] * d[:, None, :]
        of_reach = S[:, None, None] * one + more * tt
        of_reach[away, -1, -1] = 0.0
        mixed = more * (td + axial * across) / long
        of_turn = more * (dd - axial * (axial * across + td + td.transpose(0, 2, 1))) / long**2
        W = np.block([[of_reach, mixed], [mixed.transpose(0, 2, 1), of_turn]])
        count, each = W.shape[:2]
        columns = np.tile(np.arange(count)[:, None] + count * np.arange(each), (each, 1))
        among = sparse.csr_matrix((W.transpose(1, 0, 2).ravel(), columns.ravel(), each * np.arange(each * count + 1)))
        return (self._ways.T @ among @ self._ways).tocsc()

    def masses(self) -> sparse.csc_matrix:
        """Masses of the unknowns, (unknown, unknown) kg."""
        restrained, mass = self.structure.restraints, self.structure.nodes.mass.copy()
        np.add.at(mass, restrained.node[restrained.first], restrained.mass)
        M = sparse.block_diag([sparse.diags(np.tile(mass, self.axes)), self.loaded.masses()])
        return (self.free.T @ M @ self.free).tocsc()

    def damping(self, shape: Array) -> sparse.csc_matrix:
        """Forces of axial dampers, drag, wind, supports and bodies over velocities of the unknowns, N s/m."""
        runs, nodes, n = self.structure.runs, self.structure.nodes, self.axes
        r, u = self._look(shape)
        rows, felt, on = self.rows(r), np.zeros(nodes.mass.size), self.loaded.on
        for first, links, h, c in zip(runs.first, runs.links, runs.h, runs.damping, strict=True):
            part = slice(first, first + links)
            felt[part] = c / (h * self.buffers.length[part] ** 2)
        if on.size and not self.structure.is_linearised:  # kinks lengthen links, too
            rows = rows + self.borne().T @ sparse.diags(self.loaded.contacts["by_tension"][on]) @ self.stretched()
        C = rows.T @ scaled(rows.tocsr(), felt)
        by_wind = damping_by_wind(self.structure, r, float(self.loaded.state.t[0]))
        by_nodes = sparse.diags(np.tile(nodes.mass * nodes.drag, n)) + by_wind
        by_nodes = sparse.block_diag([by_nodes, self.loaded.damping(u)])
        C = C + by_nodes + self._of_groups("damping", r, u.size) + self._of_restraints("damping")
        C = (self.free.T @ C.tocsc() @ self.free).tocsc()
        C.eliminate_zeros()
        return C

    def pattern(self, shape: Array) -> sparse.csc_matrix:
        at, found = self._stiff  # who asks for both does so one after the other
        K, structure = abs(found if at is shape else self.stiffness(shape)), self.structure
        n, count = structure.nodes.mass.size, self.loaded.weight.size
        # Cells and ties that are slack, and lines that are drawn straight up over sheaves, have zeros there now.
        near = [group.neighbours(n) for group in (structure.surfaces, structure.ties) if group is not None]
        if structure.sheaves is not None:
            near.append(neighbours_of(structure.sheaves, structure.runs, n, self.axes))
        if structure.saddles is not None:
            near.append(structure.saddles.neighbours(shape[: n * self.axes].reshape(self.axes, n)))
        turned = self.loaded.neighbours()
        none = sparse.csc_matrix((count, count))
        parts = [sparse.block_diag([part, none]) for part in near]
        parts.append(sparse.block_diag([sparse.csc_matrix((n * self.axes, n * self.axes)), turned]))
        if self.loaded.on.size:
            parts.append(self._around_contacts(count))
        if (structure.runs.bending == 0.0).any():  # lines may be straight now
            parts.append(self._of_any_shape(count))
        free = abs(self.free)
        K = K + free.T @ sum(parts[1:], start=parts[0]) @ free
        return (K + K.T).tocsc()

    def _of_any_shape(self, count: int) -> sparse.csc_matrix:
        """Which places may feel which by the links of lines, whatever their shape, (place, place)."""
        n, rng = self.structure.nodes.mass.size, np.random.default_rng(0)
        rows = self._forms.lengthened.of(rng.random(3 * self.axes * n))
        return abs(self._forms.across.of(rng.random((3 * self.axes + 1) * n))) + abs(rows.T @ rows)

    def _around_contacts(self, count: int) -> sparse.csc_matrix:
        """Which places may feel which under contacts that have no kinks yet, (place, place)."""
        forms = self._forms
        links, pair = abs(self.borne()), sparse.diags([1.0, 1.0], [0, 1], shape=forms.one.shape)
        nodes = links @ (abs(forms.one) + pair @ abs(forms.two) + abs(forms.three))
        own = sparse.csr_matrix((nodes.shape[0], count))
        near = self._summed(np.ones((nodes.shape[0], 2 * self.axes))) @ abs(self._ways)
        felt = sparse.hstack([*([nodes] * self.axes), own]) + near
        return felt.T @ (sparse.identity(nodes.shape[0]) + links @ links.T) @ felt

    def stability(self, shape: Array) -> tuple[sparse.csc_matrix, Integers]:
        K, inner = self.stiffness(shape), np.arange(self.free.shape[1])
        if self.within and self.axes == 3:
            n = self.structure.nodes.mass.size
            across = np.zeros(self.free.shape[0], dtype=np.bool_)
            across[n : 2 * n] = True
            inner = np.flatnonzero(np.asarray(abs(self.free[across]).sum(axis=0)).ravel() == 0.0)
        return K[inner][:, inner].tocsc(), inner

    def part(self, shape: Array, way: Array) -> str:
        return named_part(self.structure, shape, way, self.loaded.rest.shape)

    def moved(self, shape: Array, step: Array) -> Array:
        way = np.asarray(self.free @ step)
        if self.structure.sheaves is not None and not self.structure.is_linearised:
            n = self.axes * self.structure.nodes.mass.size
            way *= part_until_passing(self.structure.sheaves, self.structure.runs, way[:n].reshape(self.axes, -1))
        return np.asarray(shape + way)

    def arrived(self, shape: Array) -> tuple[Array, bool]:
        structure, sheaves, runs = self.structure, self.structure.sheaves, self.structure.runs
        if sheaves is None or structure.is_linearised:  # no node passes in small motion
            return shape, False
        before, r = runs.links.copy(), self.put(shape)[0]
        push_over(sheaves, runs, r)
        if not pass_nodes_entry(
            sheaves,
            structure.lines,
            runs,
            structure.nodes.mass,
            structure.inertia,
            r,
            np.zeros_like(r),
            np.zeros(WORKS),
        ):
            raise EquilibriumError("a line runs over a sheave up to its end; make it longer, or hold that end")
        passed = bool((before != runs.links).any())
        if passed:
            self.divide()
        return self.taken(), passed

    def approaches(self, start: Array, way: Way) -> Iterator[Array]:
        """Shapes of softer lines that become stiffer, see `softening.py`."""
        return stiffened(self, start, float(np.abs(self.loaded.weight).sum()), way)
