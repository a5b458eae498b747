"""Draws the figures of the pages of the scenario file, images/file/*.svg:  python docs/images/keys.py"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

from drawing import FAINT, INK, KEY, LOAD, Drawing, hanging, on

FOLDER = Path(__file__).with_name("file")


def lines() -> Drawing:
    """Ends, length, a segment, a cut, nodes."""
    d = Drawing(235, "A line between two supports and the keys that describe it")
    rope = hanging((60, 70), (660, 40), 110)
    d.path(rope)
    for k in range(0, 61, 4):
        d.circle(rope[k], 3)
    d.path(rope[24:33], KEY, 5)
    d.ground((60, 70))
    d.ground((660, 40))
    d.key((60, 58), "start")
    d.key((660, 28), "end")
    d.key((200, 60), "start_support", "middle")
    d.arrow((140, 62), (82, 78), FAINT)
    x, y = on(rope, 0.75)
    d.path([(x - 6, y - 14), (x + 6, y + 14)], LOAD, 2)
    d.key((x + 12, y + 24), "cut.at", "start")
    d.key((400, 215), "segments: {from, to, mass, bending_stiffness, damage}")
    d.arrow((345, 200), (345, 175), FAINT)
    d.key((360, 70), "length / tension")
    d.key((360, 92), "mass, axial_stiffness, bending_stiffness")
    d.key((100, 185), "elements")
    d.arrow((120, 172), on(rope, 0.2667), FAINT)
    return d


def supports() -> Drawing:
    """The kinds, and a saddle."""
    d = Drawing(215, "Kinds of supports, and a saddle")
    names = ("fixed", "elastic", "guided", "moving")
    for k, name in enumerate(names):
        x = 75 + 120 * k
        d.path([(x, 70), (x + 62, 82)], INK, 2.5)
        d.circle((x, 70), 4)
        d.key((x, 30), f"kind: {name}")
    d.ground((75, 70))
    d.spring((188, 70), (188, 125))
    d.damper((202, 74), (202, 125))
    d.path([(188, 72), (202, 72)], INK, 1.4)
    d.hatch((175, 125), (215, 125))
    d.key((195, 160), "stiffness")
    d.key((195, 178), "damping, mass")
    d.path([(285, 60), (345, 60)], FAINT, 1.5)
    d.path([(285, 80), (345, 80)], FAINT, 1.5)
    d.box((315, 70), 22, 16)
    d.arrow((304, 70), (270, 70), LOAD)
    d.key((315, 110), "along, force")
    d.arrow((435, 78), (435, 120), LOAD)
    d.key((435, 143), "displacement")
    crown, radius = (610, 80), 70
    angles = [math.radians(g) for g in range(-40, 41, 4)]
    arc = [(610 + radius * math.sin(a), 150 - radius * math.cos(a)) for a in angles]
    d.path([(500, 118), *arc, (712, 112)], INK, 2.5)
    d.path([(arc[0][0] - 2, arc[0][1] + 7), *[(x, y + 6) for x, y in arc], (arc[-1][0] + 2, arc[-1][1] + 7)], FAINT, 5)
    d.circle(crown, 4, KEY)
    d.key((610, 30), "saddles: {at, friction}")
    d.arrow((610, 38), (610, 72), FAINT)
    d.arrow((610, 150), (655, 97), FAINT)
    d.key((632, 140), "radius", "start")
    d.path([(610, 90), (610, 188)], INK, 3)
    d.hatch((585, 188), (635, 188))
    d.key((598, 178), "support", "end")
    return d


def loads() -> Drawing:
    """Five loads on one line."""
    d = Drawing(250, "Kinds of loads on a line")
    d.path([(20, 130), (700, 130)], INK, 3)
    d.arrow((70, 60), (70, 126), LOAD)
    d.key((70, 45), "kind: force")
    d.circle((190, 114), 15, LOAD)
    d.key((190, 45), "kind: mass")
    d.box((310, 78), 46, 26, LOAD)
    d.spring((300, 91), (300, 121), LOAD)
    d.damper((320, 91), (320, 121))
    d.circle((310, 124), 6)
    d.key((310, 45), "kind: oscillator")
    d.key((338, 108), "stiffness", "start")
    d.circle((450, 124), 6)
    d.path([(450, 130), (468, 205)], INK, 1.6)
    d.circle((470, 215), 11, LOAD)
    d.key((450, 45), "kind: trolley")
    d.key((487, 220), "payload", "start")
    d.key((468, 180), "length", "start")
    d.box((620, 78), 120, 26, LOAD)
    for x in (580, 660):
        d.spring((x, 91), (x, 120), LOAD)
        d.circle((x, 124), 6)
    d.circle((620, 137), 2, KEY, KEY)
    d.measure((620, 152), (660, 152), "wheels: at", 18)
    d.key((620, 45), "kind: vehicle")
    d.key((620, 83), "bodies")
    d.key((616, 112), "springs")
    d.key((90, 160), "on, travel", "middle")
    d.key((90, 215), "lift_off, side, contact_stiffness", "start")
    return d


def travel() -> Drawing:
    """Four measures, margin and brake."""
    d = Drawing(260, "The place of a load and its measures")
    rope = hanging((50, 40), (670, 120), 70)
    d.path(rope)
    d.ground((50, 40))
    d.ground((670, 120))
    x, y = on(rope, 0.4)
    d.circle((x, y - 11), 11, LOAD)
    d.arrow((x + 16, y - 14), (x + 74, y + 2), LOAD)
    d.key((x + 60, y - 22), "speed")
    d.path([(p, q + 12) for p, q in rope[:25]], KEY, 1.4, "5 3")
    d.text((58, 158), "material: unstrained length", INK, "start", 13)
    d.text((58, 175), "slip, arc: strained length", INK, "start", 13)
    d.path([(50, 60), (50, 200)], FAINT, 1, "3 3")
    d.path([(x, y + 4), (x, 200)], FAINT, 1, "3 3")
    d.arrow((50, 192), (x, 192), FAINT, both=True)
    d.text((175, 210), "horizontal", INK, "middle", 13)
    d.key((175, 236), "measured, from")
    d.path(rope[48:58], LOAD, 5)
    d.key((535, 195), "brake: {force, rate, stiffness, within}")
    d.arrow((560, 180), on(rope, 0.88), FAINT)
    d.path(rope[58:], KEY, 5)
    d.key((640, 88), "margin")
    d.key((535, 236), "at_end: refuse, leave, stay")
    return d


def trains() -> Drawing:
    """Coaches and axles."""
    d = Drawing(220, "Axles of coaches on a bridge")
    d.path([(250, 140), (520, 140)], INK, 4)
    d.path([(20, 140), (250, 140)], FAINT, 1.5, "6 4")
    d.path([(520, 140), (700, 140)], FAINT, 1.5, "6 4")
    d.ground((252, 142))
    d.ground((518, 142))
    for k in range(4):
        x = 60 + 150 * k
        d.box((x + 66, 88), 136, 24, FAINT)
        for at in (20, 112):
            d.arrow((x + at, 106), (x + at, 136), LOAD)
    d.measure((80, 66), (230, 66), "coaches: {count, length}")
    d.measure((530, 158), (622, 158), "at", 18)
    d.key((126, 126), "forces")
    d.arrow((660, 88), (705, 88), LOAD)
    d.key((655, 50), "travel.speed")
    d.key((385, 172), "on")
    d.text((360, 205), "a train of vehicles has bodies, wheels and springs instead of forces", INK, "middle", 13)
    return d


def tracks() -> Drawing:
    """Layers below a rail."""
    d = Drawing(235, "Rail, pads, sleepers and ballast on a bridge and on the ground")
    d.path([(30, 50), (560, 50)], INK, 5)
    for k in range(7):
        x = 70 + 75 * k
        d.spring((x, 53), (x, 84))
        d.box((x, 92), 44, 16)
        d.spring((x, 100), (x, 136))
        d.box((x, 142), 54, 12, FAINT)
        if k in (0, 1, 5, 6):
            d.spring((x, 148), (x, 184))
            d.hatch((x - 24, 184), (x + 24, 184))
    d.path([(195, 152), (395, 152)], INK, 5)
    d.ground((200, 154))
    d.ground((390, 154))
    d.measure((70, 28), (145, 28), "sleepers.spacing")
    d.key((580, 54), "rail", "start")
    d.key((580, 74), "pads", "start")
    d.key((580, 97), "sleepers", "start")
    d.key((580, 134), "ballast", "start")
    d.key((580, 174), "subgrade", "start")
    d.key((295, 200), "over: [deck]")
    return d


def ropeways() -> Drawing:
    """A carriage on rockers."""
    d = Drawing(275, "A carriage on rockers with its cabin and its hauling rope")
    d.path([(20, 90), (700, 62)], INK, 3)
    level = [(300, 62), (330, 61), (390, 58), (420, 57)]
    for x, y in level:
        d.circle((x, y + 9), 9)
    for (x0, y0), (x1, _) in zip(level[::2], level[1::2], strict=True):
        d.path([(x0, y0 + 9), ((x0 + x1) / 2, y0 - 16), (x1, y0 + 8)], INK, 2)
    d.path([(315, 46), (360, 20), (405, 42)], INK, 2)
    d.measure((300, 102), (330, 102), "rockers[0]", 18)
    d.measure((315, 140), (405, 140), "rockers[1]", 18)
    d.path([(360, 20), (360, 190)], LOAD, 2)
    d.box((360, 222), 90, 64, LOAD)
    d.key((360, 226), "cabin")
    d.measure((450, 22), (450, 222), "hanger")
    d.path([(372, 30), (690, 16)], KEY, 1.6)
    d.arrow((640, 18), (690, 16), KEY)
    d.key((610, 42), "haul: {to, speed}")
    d.key((150, 68), "on")
    d.key((250, 30), "mass, wheel_mass")
    d.key((150, 190), "travel: {kind: free, from}")
    return d


def people() -> Drawing:
    """Footsteps, walker, crowd."""
    d = Drawing(220, "Footsteps, a walker, a crowd")
    d.path([(20, 150), (700, 150)], INK, 3)
    for k, x in enumerate((50, 85, 120, 155)):
        d.arrow((x, 90 + 8 * (k % 2)), (x, 146), LOAD)
    d.key((102, 50), "kind: footsteps")
    d.text((102, 70), "forces as told", INK, "middle", 13)
    d.measure((50, 172), (85, 172), "step_length", 18)
    hip = (310, 84)
    d.circle(hip, 13, LOAD)
    d.spring(hip, (290, 148), LOAD)
    d.spring(hip, (332, 148), LOAD)
    d.key((310, 50), "kind: walker")
    d.key((348, 100), "leg_length", "start")
    d.text((348, 120), "legs that respond", INK, "start", 13)
    for k in range(9):
        x = 490 + 24 * k
        d.circle((x, 104 + 5 * (k % 3)), 5, LOAD)
        d.path([(x, 110 + 5 * (k % 3)), (x, 132), (x - 5, 147)], LOAD, 1.6)
        d.path([(x, 132), (x + 5, 147)], LOAD, 1.6)
    d.key((590, 50), "kind: crowd")
    d.key((590, 70), "number, mass, frequency")
    d.key((360, 205), "on, from, towards")
    return d


def own() -> Drawing:
    """How line and model take turns."""
    d = Drawing(220, "The line and a model of your own take turns")
    d.box((150, 80), 180, 70)
    d.text((150, 85), "line of ropewalk")
    d.box((570, 80), 200, 70, LOAD)
    d.key((570, 76), "kind: stepper, fmu")
    d.text((570, 98), "your model", LOAD)
    d.arrow((242, 62), (466, 62))
    d.text((354, 50), "place, height, velocity of contacts", INK, "middle", 13)
    d.arrow((466, 98), (242, 98))
    d.text((354, 118), "forces (or motion)", INK, "middle", 13)
    d.path([(60, 170), (660, 170)], FAINT, 1.4)
    for k in range(7):
        d.path([(60 + 100 * k, 162), (60 + 100 * k, 178)], INK, 1.6)
    d.measure((60, 152), (160, 152), "every")
    d.key((410, 150), "exchange: {scheme, order, damping}")
    d.text((360, 205), "in between the line takes many steps of its own", INK, "middle", 13)
    return d


def networks() -> Drawing:
    """Joint, joined, hangers, sheave."""
    d = Drawing(260, "Lines joined by a joint, by hangers, and a sheave")
    d.path([(20, 60), (110, 130)], INK, 2.5)
    d.path([(200, 50), (110, 130)], INK, 2.5)
    d.path([(110, 130), (110, 200)], INK, 2.5)
    d.circle((110, 130), 7, KEY)
    d.ground((20, 60))
    d.ground((200, 50))
    d.key((130, 140), "joints: ring", "start")
    d.key((8, 225), "end_support: {kind: joined}", "start")
    cable = hanging((270, 60), (490, 60), 62)
    d.path(cable, INK, 2.5)
    d.path([(270, 170), (490, 170)], INK, 4)
    for k in range(1, 8):
        x, y = on(cable, k / 8)
        d.path([(x, y), (x, 168)], KEY, 1.6)
    d.ground((270, 60))
    d.ground((490, 60))
    d.ground((270, 172))
    d.ground((490, 172))
    d.key((380, 50), "hangers: {from, to, count}")
    d.path([(530, 220), (600, 82), (620, 70), (640, 80), (710, 150)], INK, 2.5)
    d.circle((619, 90), 20, KEY)
    d.key((620, 40), "sheaves: {at, friction}")
    return d


def nets() -> Drawing:
    """Corner, sides, cells, path, edge."""
    d = Drawing(260, "A net and the keys that describe it")
    o, u, v = (170.0, 200.0), (320.0, 20.0), (90.0, -150.0)

    def place(a: float, b: float) -> tuple[float, float]:
        return o[0] + a * u[0] + b * v[0], o[1] + a * u[1] + b * v[1]

    for k in range(1, 8):
        d.path([place(k / 8, 0), place(k / 8, 1)], FAINT, 1)
    for k in range(1, 6):
        d.path([place(0, k / 6), place(1, k / 6)], FAINT, 1)
    d.path([place(0, 0), place(1, 0), place(1, 1), place(0, 1), place(0, 0)], INK, 3)
    d.circle(o, 5, KEY)
    d.key((o[0] - 12, o[1] + 20), "corner", "end")
    d.arrow((o[0] + 8, o[1] + 14), (490, 234), KEY)
    d.key((340, 250), "sides[0]: u")
    d.arrow((o[0] - 12, o[1] - 8), (250, 50), KEY)
    d.key((190, 100), "sides[1]: v", "end")
    path = [place(0.2, 0.25), place(0.55, 0.4), place(0.8, 0.8)]
    d.path(path, LOAD, 2, "6 4")
    d.circle(path[1], 7, LOAD)
    d.key((600, 115), "travel.path", "start")
    d.arrow((595, 111), (path[1][0] + 12, path[1][1]), FAINT)
    d.key((620, 70), "edge", "start")
    d.arrow((614, 66), place(0.98, 1), FAINT)
    d.key((600, 165), "cells", "start")
    d.arrow((595, 161), place(0.9, 0.42), FAINT)
    return d


def overhead_lines() -> Drawing:
    """A span and a pantograph."""
    d = Drawing(300, "A span of an overhead line and a pantograph")
    a, b = 130.0, 555.0
    messenger, contact = hanging((a, 50), (b, 50), 60), hanging((a, 165), (b, 165), 9)
    d.path(messenger, INK, 2)
    d.path(contact, INK, 3)
    for k in range(1, 8):
        d.path([on(messenger, k / 8), on(contact, k / 8)], KEY, 1.4)
    d.path([(a, 30), (a, 260)], FAINT, 3)
    d.path([(b, 30), (b, 260)], FAINT, 3)
    d.path([(b, 130), (b - 55, 166)], INK, 2)
    d.key((b + 8, 128), "steady_arms", "start")
    d.key((b + 8, 56), "messenger_supports", "start")
    d.arrow((114, 52), (114, 165), FAINT, both=True)
    d.key((108, 112), "system_height", "end")
    d.key((340, 96), "messenger_wire")
    d.key((470, 150), "droppers")
    d.key((200, 200), "contact_wire, pre_sag")
    d.measure((a, 20), (b, 20), "spans: {count, length}", 18)
    x, y = on(contact, 0.55)
    d.path([(x - 26, y + 5), (x + 26, y + 5)], LOAD, 4)
    for k, name in enumerate(("head", "frame")):
        d.spring((x - 7, y + 8 + 46 * k), (x - 7, y + 42 + 46 * k), LOAD)
        d.damper((x + 9, y + 8 + 46 * k), (x + 9, y + 42 + 46 * k))
        if k == 0:
            d.box((x, y + 48), 50, 12, LOAD)
        d.text((x + 34, y + 12 + 44 * k), name, LOAD, "start", 13)
    d.hatch((x - 26, y + 90), (x + 26, y + 90))
    d.key((x - 40, y + 50), "masses, stiffness, damping", "end")
    d.key((x - 40, y + 76), "static_force / mean_force", "end")
    d.arrow((x + 80, y + 50), (x + 140, y + 50), LOAD)
    d.key((x + 90, y + 72), "travel.speed", "start")
    return d


def runs() -> Drawing:
    """Kinds of runs, instants."""
    d = Drawing(240, "Kinds of runs and the instants of a motion")
    names = ("equilibrium", "quasistatic", "dynamic", "linear")
    words = ("one place, at rest", "all places, slowly", "motion, all geometry", "small motion, modes")
    for k, (name, word) in enumerate(zip(names, words, strict=True)):
        x = 95 + 178 * k
        d.key((x, 26), f"kind: {name}")
        d.text((x, 108), word, INK, "middle", 13)
        rope = hanging((x - 70, 46), (x + 70, 46), 14 if k == 3 else 36)
        d.path(rope, FAINT if k else INK, 2)
        if k in (1, 2):
            for part in (0.25, 0.5, 0.75):
                at = on(rope, part)
                d.path([rope[0], (at[0], at[1] + 6), rope[-1]], INK if part == 0.5 else FAINT, 1.4)
        if k == 3:
            d.path([(x - 70, 46), (x + 70, 46)], FAINT, 1, "4 3")
        at = on(rope, 0.5)
        d.arrow((at[0], at[1] - 22), (at[0], at[1]), LOAD)
    d.arrow((40, 180), (690, 180))
    d.text((690, 200), "t", INK)
    for k in range(61):
        d.path([(50 + 10 * k, 176), (50 + 10 * k, 184)], FAINT, 1)
    for k in range(7):
        d.path([(50 + 100 * k, 166), (50 + 100 * k, 194)], INK, 2)
    d.measure((50, 156), (150, 156), "every")
    d.key((285, 158), "step")
    d.arrow((285, 163), (285, 175), FAINT)
    d.key((652, 158), "until")
    d.text((360, 222), "output at each long mark; contact forces of pantographs at every sample", INK, "middle", 13)
    return d


def outputs() -> Drawing:
    """A place on a deck and the ground below."""
    d = Drawing(190, "A deck with a place of which results report, and the ground below")
    deck = hanging((80, 60), (640, 60), 22)
    d.path([(80, 60), (640, 60)], FAINT, 1, "4 3")
    d.path(deck)
    d.ground((80, 60))
    d.ground((640, 60))
    at = on(deck, 0.5)
    d.circle(at, 5, KEY)
    d.key((at[0], 34), "places: {on, at}", "middle")
    floor = [(60, 150), (220, 165), (430, 140), (660, 155)]
    d.path(floor, LOAD, 2)
    for point in floor:
        d.circle(point, 4, LOAD)
    d.key((360, 182), "ground", "middle")
    return d


def sweeps() -> Drawing:
    """Cases of a grid, and one quantity of each."""
    d = Drawing(200, "Cases of a sweep over two keys, and a quantity of each")
    for i in range(5):
        for j in range(3):
            d.circle((110 + 45 * i, 50 + 40 * j), 6, KEY)
    d.arrow((80, 165), (325, 165))
    d.arrow((80, 165), (80, 25))
    d.key((200, 188), "over", "middle")
    d.text((205, 20), "combine: grid", INK, "middle", 13)
    d.arrow((345, 95), (400, 95), FAINT)
    d.arrow((430, 165), (680, 165))
    d.arrow((430, 165), (430, 25))
    d.path([(445, 140), (490, 120), (535, 60), (580, 45), (625, 95), (665, 115)], LOAD, 2.4)
    d.key((555, 188), "record", "middle")
    return d


def wind() -> Drawing:
    """Wind across a line."""
    d = Drawing(190, "Wind that blows at a line and a load")
    rope = hanging((80, 40), (640, 40), 70)
    d.path(rope)
    d.ground((80, 40))
    d.ground((640, 40))
    for k in range(6):
        end = on(rope, 0.08 + 0.168 * k)
        d.arrow((end[0] - 55, end[1] + 34), (end[0] - 4, end[1] + 4), LOAD)
    load = on(rope, 0.5)
    d.box((load[0], load[1] + 14), 26, 20)
    d.key((360, 178), "direction, speed", "middle")
    d.key((500, 60), "wind_drag", "start")
    d.key((load[0] + 24, load[1] + 24), "air_drag", "start")
    return d


FIGURES: dict[str, Callable[[], Drawing]] = {
    "lines": lines, "supports": supports, "loads": loads, "travel": travel, "trains": trains, "tracks": tracks,
    "ropeways": ropeways, "people": people, "own": own, "networks": networks, "nets": nets,
    "overhead-lines": overhead_lines, "runs": runs, "outputs": outputs, "sweeps": sweeps, "wind": wind,
}  # fmt: skip

if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, figure in FIGURES.items():
        figure().save(FOLDER / f"{name}.svg")
    print(f"{len(FIGURES)} figures written")
