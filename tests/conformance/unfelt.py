"""Keys that are not felt in a base, each with its reason; and those that no base could make felt."""

from __future__ import annotations

from .bases import BASES

Reasons = dict[str, dict[str, tuple[str, ...]]]
"""By key, or `key=value` for one of its values: why it is not felt, and in which bases."""

NEVER: dict[str, str] = {
    "Fmu.isolated": "where it is computed is no matter of what is computed",
    "Fmu.patience": "is waited for only when an FMU does not answer",
    "OverheadLine.analysed_spans": "says what statistics speak of, which are made from a result later",
    "Stepper.from": "is handed to a model that asks for it; the model of the bases says itself where it presses",
    "InnerFixed.clamped": "an inner support lets the line turn, and says so where it is to be clamped",
    "InnerGuided.winch": "a winch pulls at an end of a line, and is refused between its ends",
    "Sheave.to": "the joint of the base hangs on its sheave alone, and is refused without it",
    "Exchange.warn": "no exchange of the bases makes energy that could be warned of",
    "FmuContact.gives": "the FMU of the bases gives a force; what it would need to give its motion is refused",
    "MessengerSupports.along": "what the bases have given decides it, and the contrary is refused",
    "PantographTravel.at_end": "no pantograph of the bases comes to the end; what would pass it is refused",
    "Matrices.lift_off": "nothing leaves the line in the bases that have it",
    "Trolley.lift_off": "nothing leaves the line in the bases that have it",
    "Cabin.floor": "is for the clearance, which summaries tell; tests/system/test_carriages.py has",
    "Line.strength": "is for doubts and summaries; tests/system/test_breaking.py has",
    "FmuTravel.path": "is for nets, on which no base has such a load; tests/system/test_loads_on_nets.py has",
    "Crowd.path": "is for nets, on which no base has people; tests/test_crowds.py has",
    "FreeTravel.path": "is for nets, on which no base has such a load; tests/system/test_loads_on_nets.py has",
    "Stepper.path": "is for nets, on which no base has such a load; tests/system/test_loads_on_nets.py has",
    "Equilibrium.accuracy": "is for elements: auto, which no base has; tests/meshes/test_chosen_meshes.py has",
    "Quasistatic.accuracy": "is for elements: auto, which no base has; tests/meshes/test_chosen_meshes.py has",
    "Walker.path": "is for nets, on which no base has such a load; tests/system/test_loads_on_nets.py has",
}
"""Keys that change no number in any base, by nature or because the bases are too small for it."""

UNFELT: Reasons = {
    "Droppers.pushes": {"no dropper of the other line slackens": ("pantograph",)},
    "Line.law": {"its hysteresis stays, which does not go with such a law": ("webbing", "measured webbing")},
    "Line.strength": {"is for doubts and summaries": tuple(name for name, tree in BASES.items() if tree.get("lines"))},
    "Dynamic.method": {
        "auto has chosen an explicit method already, that of Verlet": (
            "plain",
            "webbing",
            "measured webbing",
            "stretch",
            "carriage",
            "two carriages",
            "hoisted",
            "rough",
            "train of vehicles",
            "crowd",
            "shoe",
            "steps",
            "tracked",
            "winch",
            "held",
            "earlier",
            "force in time",
            "free mass",
            "free end",
            "oscillator",
            "mass",
            "free oscillator",
            "light wheel",
            "trolley",
            "vehicle",
            "matrices",
            "footsteps",
            "walker",
            "stepper",
            "fmu",
            "mode",
            "stiff",
            "stiff fmu",
            "bed",
            "pantograph",
            "staggered",
            "joined",
            "ring",
            "block",
            "wind",
            "net",
            "outline",
            "membrane",
            "awning",
        ),
    },
    "Exchange.order": {
        "what the model gives does not change, so any order continues it alike": (
            "stepper",
            "fmu",
        ),
    },
    "Exchange.warn": {
        "the exchange makes no energy here that could be warned of": (
            "stepper",
            "fmu",
            "stiff fmu",
        ),
    },
    "Fmu.isolated": {
        "where it is computed is no matter of what is computed": (
            "fmu",
            "stiff fmu",
        ),
    },
    "Fmu.patience": {
        "is waited for only when an FMU does not answer": (
            "fmu",
            "stiff fmu",
        ),
    },
    "FmuContact.force_along": {
        "forces along a stiff line are refused when the FMU gives them": ("stiff fmu",),
    },
    "FmuContact.height_from": {
        "the line begins at z = 0 there": ("stiff fmu",),
    },
    "FmuTravel.at_end": {
        "nothing comes to an end of the line": ("stiff fmu",),
    },
    "FmuTravel.measured": {
        "the line is straight and as long as its chord, or does not stretch: both count the same": ("stiff fmu",),
    },
    "Footsteps.at_end": {
        "nothing comes to an end of the line": (
            "wind",
            "awning",
        ),
    },
    "Footsteps.first_foot": {
        "feet that press downwards only are alike": (
            "wind",
            "awning",
        ),
    },
    "Footsteps.overlap": {
        "the run ends on the first feet": ("awning",),
    },
    "Footsteps.step_length": {
        "the run ends on the first feet": ("awning",),
    },
    "Footsteps.towards": {
        "the second step comes after the run has ended": ("awning",),
    },
    "FreeTravel.at_end": {
        "nothing comes to an end of the line": (
            "free mass",
            "free oscillator",
            "trolley",
        ),
    },
    "FreeTravel.margin": {
        "nothing comes so near to an end": (
            "free oscillator",
            "trolley",
            "free mass",
        ),
    },
    "Line.axial_damping": {
        "what damps is felt in motion, not at rest": (
            "slow",
            "rest",
        ),
        "damps changes of length, of which small deflections have none": (
            "linear",
            "linear mass",
            "linear vehicle",
        ),
    },
    "Line.axial_stiffness": {
        "a line laid at the length of its chord moves across itself only in small motion": ("bed",),
    },
    "Line.drag": {
        "what damps is felt in motion, not at rest": (
            "slow",
            "inextensible",
            "rest",
            "hung",
            "stiff rest",
        ),
    },
    "Line.damping": {
        "what damps is felt in motion, not at rest": ("slow", "inextensible", "rest", "stiff rest"),
    },
    "Line.retardation": {
        "what damps is felt in motion, not at rest": ("slow", "inextensible", "rest", "stiff rest"),
    },
    "Line.end_support": {
        "the implicit method refuses what yields, by the name of the method": ("tabulated",),
    },
    "Line.start_support": {
        "the implicit method refuses what yields, by the name of the method": ("tabulated",),
    },
    "Line.tension": {
        "a tension of 9 kN leaves too little rope for a rope of a few newtons to go over its sheave": ("block",),
    },
    "Matrices.lift_off": {
        "the load stays on the line, or has no reason to leave it": ("matrices",),
    },
    "MessengerSupports.along": {
        "is what is meant where it is left out": (
            "pantograph",
            "staggered",
        ),
    },
    "MovingMass.lift_off": {
        "the load stays on the line, or has no reason to leave it": (
            "webbing",
            "measured webbing",
            "stretch",
            "free mass",
            "mass",
            "outline",
            "membrane",
        ),
    },
    "MovingForce.friction_model": {
        "a net does not bend around a load: friction is mu times what presses in both models": ("net", "net at rest"),
    },
    "Net.axial_damping": {
        "what damps is felt in motion, not at rest": ("net at rest",),
    },
    "Net.drag": {
        "what damps is felt in motion, not at rest": ("net at rest",),
    },
    "Oscillator.lift_off": {
        "the load stays on the line, or has no reason to leave it": (
            "free oscillator",
            "light wheel",
            "stiff",
        ),
    },
    "OverheadLine.analysed_spans": {
        "says what statistics speak of, which are made from a result later": (
            "pantograph",
            "staggered",
        ),
    },
    "Pantograph.model": {
        "the one of the base is the published one": ("staggered",),
    },
    "PantographTravel.at_end": {
        "nothing comes to an end of the line": ("pantograph", "staggered"),
    },
    "Scenario.gravity": {
        "without its weight, or with less of it, there is no rest to begin from": (
            "staggered",
            "block",
        ),
    },
    "Scenario.loads": {
        "quasi-static runs are those of loads, and are refused without them": (
            "slow",
            "inextensible",
        ),
    },
    "Sheave.to": {
        "without it the joint hangs on nothing, which is refused": ("block",),
    },
    "Stepper.from": {
        "a model of one's own says itself where it presses": ("stepper",),
    },
    "Travel.at_end": {
        "nothing comes to an end of the line": (
            "webbing",
            "measured webbing",
            "stretch",
            "plain",
            "shoe",
            "steps",
            "tracked",
            "hung",
            "winch",
            "held",
            "earlier",
            "force in time",
            "oscillator",
            "light wheel",
            "vehicle",
            "matrices",
            "tabulated",
            "slow",
            "inextensible",
            "rest",
            "linear",
            "linear mass",
            "linear vehicle",
            "stiff",
            "bed",
            "joined",
            "ring",
            "block",
            "net",
            "outline",
            "membrane",
            "net at rest",
        ),
    },
    "Travel.from": {
        "modes are for what enters at an end, which is refused otherwise": ("linear",),
    },
    "Travel.measured": {
        "the line is straight and as long as its chord, or does not stretch: both count the same": (
            "inextensible",
            "linear vehicle",
            "bed",
        ),
    },
    "Trolley.lift_off": {
        "the load stays on the line, or has no reason to leave it": ("trolley", "hoisted"),
    },
    "Vehicle.lift_off": {
        "the load stays on the line, or has no reason to leave it": (
            "vehicle",
            "bed",
        ),
    },
}

KNOWN_IGNORED: Reasons = {}
"""Keys that should be felt or refused, and are not, yet."""
