"""Small FMUs, built for the tests: of C for FMI 2.0 and 3.0, and of Python with pythonfmu.

All are the same vehicle: a mass on a spring and a damper above its contact, whose force counts positive in compression.
A parameter `mood` makes it misbehave in the step that begins at or after the parameter `at`.
"""

from __future__ import annotations

import inspect
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

# Reference, name, C name, causality, variability, start value of every real variable.
REALS = [
    (1, "height", "u", "input", "continuous", 0.0),
    (2, "velocity", "v", "input", "continuous", 0.0),
    (3, "place", "xi", "input", "continuous", 0.0),
    (4, "push", "push", "input", "continuous", 0.0),
    (5, "force", "force", "output", "continuous", None),
    (6, "seen", "seen", "output", "continuous", None),  # mean height in the last step
    (7, "seen_place", "seen_place", "output", "continuous", None),
    (8, "clock", "clock", "output", "continuous", None),
    (9, "mass", "mass", "parameter", "fixed", 10.0),
    (10, "stiffness", "stiffness", "parameter", "fixed", 1000.0),
    (11, "damping", "damping", "parameter", "fixed", 0.0),
    (12, "at", "at", "parameter", "fixed", 0.0),
    (13, "z", "z", "local", "continuous", 0.0),
    (14, "w", "w", "local", "continuous", 0.0),
    (15, "height_out", "height_out", "output", "continuous", None),
    (16, "speed_of_light", "light", "output", "constant", 299792458.0),
]
MOODS = ["good", "segfault", "discard", "error", "fatal", "nan", "hang", "refuse_to_begin", "shout", "end", "quit"]
MOOD, EAGER, LABEL = 17, 18, 19  # references of an enumeration, a truth value, and a text

STATE = ", ".join(f"{c}" for _, _, c, *_ in REALS)
C = r"""
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
typedef struct { double @STATE@, slope; int mood, eager; char label[80]; } Values;
typedef struct { Values now; void *environment; Log log; int live; } Self;
static void reset(Values *a) { memset(a, 0, sizeof *a); @STARTS@ }
static double *real(Self *s, unsigned reference) { switch (reference) { @CASES@ } return NULL; }
static void outputs(Values *a) {
    a->force = a->mass * 9.81 * (a->eager ? 2 : 1) + a->stiffness * (a->u - a->z) + a->damping * (a->v - a->w);
    a->seen_place = a->xi;
    a->height_out = a->z;
}
static int get(Self *s, const unsigned *refs, size_t n, double *values) {
    outputs(&s->now);
    for (size_t i = 0; i < n; i++) { double *x = real(s, refs[i]); if (!x) return 3; values[i] = *x; }
    return 0;
}
static int set(Self *s, const unsigned *refs, size_t n, const double *values) {
    s->now.slope = 0.0;
    for (size_t i = 0; i < n; i++) { double *x = real(s, refs[i]); if (!x) return 3; *x = values[i]; }
    return 0;
}
static int begin(Self *s) {
    if (s->now.mood == 7) { say(s, 3, "I had rather not begin"); return 3; }
    if (s->now.mood == 8) say(s, 1, s->now.label);
    return 0;
}
static int step(Self *s, double t, double h) {
    Values *a = &s->now;
    if (a->mood && t >= a->at - 1e-12) {
        if (a->mood == 1) { say(s, 1, "here it comes"); *(volatile int *)8 = 1; }
        if (a->mood == 2) return 2;
        if (a->mood == 3) { say(s, 3, "the spring is broken"); return 3; }
        if (a->mood == 4) return 4;
        if (a->mood == 5) { a->z = NAN; return 0; }
        while (a->mood == 6) ;
        if (a->mood == 10) exit(0);
    }
    int parts = 20;
    double d = h / parts, u0 = a->u, sum = 0.0;
    for (int i = 0; i < parts; i++) {
        double u = u0 + a->slope * (i + 0.5) * d;
        sum += u / parts;
        a->w += d * (a->push / a->mass + a->stiffness * (u - a->z) / a->mass + a->damping * (a->v - a->w) / a->mass);
        a->z += d * a->w;
    }
    a->u = u0 + a->slope * h;
    a->seen = sum;
    a->clock = t + h;
    return 0;
}
"""
FMI2 = r"""
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *where, const Callbacks *calls,
                      int visible, int logging) {
    if (strcmp(guid, "right")) return NULL;
    Self *s = calloc(1, sizeof *s); reset(&s->now); s->log = calls->log; s->environment = calls->environment;
    return s;
}
void fmi2FreeInstance(void *s) { free(s); }
const char *fmi2GetVersion(void) { return "2.0"; }
int fmi2SetupExperiment(void *s, int a, double b, double c, int d, double e) { return 0; }
int fmi2EnterInitializationMode(void *s) { return begin(s); }
int fmi2ExitInitializationMode(void *s) { return 0; }
int fmi2Terminate(void *s) { return 0; }
int fmi2SetDebugLogging(void *s, int on, size_t n, const char *const *names) { return 0; }
int fmi2GetReal(void *s, const unsigned *refs, size_t n, double *values) { return get(s, refs, n, values); }
int fmi2SetReal(void *s, const unsigned *refs, size_t n, const double *values) { return set(s, refs, n, values); }
int fmi2SetInteger(void *s, const unsigned *r, size_t n, const int *x) { ((Self *)s)->now.mood = x[0]; return 0; }
int fmi2SetBoolean(void *s, const unsigned *r, size_t n, const int *x) { ((Self *)s)->now.eager = x[0]; return 0; }
int fmi2SetString(void *s, const unsigned *r, size_t n, const char **x) {
    strncpy(((Self *)s)->now.label, x[0], 79);
    return 0;
}
int fmi2SetRealInputDerivatives(void *s, const unsigned *refs, size_t n, const int *order, const double *values) {
    for (size_t i = 0; i < n; i++) if (refs[i] == 1) ((Self *)s)->now.slope = values[i];
    return 0;
}
int fmi2DoStep(void *s, double t, double h, int final) { return step(s, t, h); }
int fmi2GetFMUstate(void *s, void **state) {
    *state = malloc(sizeof(Values)); memcpy(*state, &((Self *)s)->now, sizeof(Values)); return 0;
}
int fmi2SetFMUstate(void *s, void *state) { memcpy(&((Self *)s)->now, state, sizeof(Values)); return 0; }
int fmi2FreeFMUstate(void *s, void **state) { free(*state); *state = NULL; return 0; }
int fmi2SerializedFMUstateSize(void *s, void *state, size_t *size) { *size = sizeof(Values); return 0; }
int fmi2SerializeFMUstate(void *s, void *state, unsigned char *data, size_t size) {
    memcpy(data, state, size); return 0;
}
int fmi2DeSerializeFMUstate(void *s, const unsigned char *data, size_t size, void **state) {
    *state = malloc(sizeof(Values)); memcpy(*state, data, size); return 0;
}
"""
FMI3 = r"""
#include <stdbool.h>
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *where, bool visible, bool logging,
                                  bool events, bool early, const unsigned *refs, size_t n, void *environment, Log log,
                                  void *update) {
    if (strcmp(token, "right")) return NULL;
    Self *s = calloc(1, sizeof *s); reset(&s->now); s->log = log; s->environment = environment;
    return s;
}
void fmi3FreeInstance(void *s) { free(s); }
const char *fmi3GetVersion(void) { return "3.0"; }
int fmi3EnterInitializationMode(void *s, bool a, double b, double c, bool d, double e) { return begin(s); }
int fmi3ExitInitializationMode(void *s) { return 0; }
int fmi3Terminate(void *s) { return 0; }
int fmi3SetDebugLogging(void *s, bool on, size_t n, const char *const *names) { return 0; }
int fmi3GetFloat64(void *s, const unsigned *refs, size_t n, double *values, size_t m) {
    return get(s, refs, n, values);
}
int fmi3SetFloat64(void *s, const unsigned *refs, size_t n, const double *values, size_t m) {
    return set(s, refs, n, values);
}
int fmi3SetInt64(void *s, const unsigned *r, size_t n, const long long *x, size_t m) {
    ((Self *)s)->now.mood = x[0];
    return 0;
}
int fmi3SetBoolean(void *s, const unsigned *r, size_t n, const bool *x, size_t m) {
    ((Self *)s)->now.eager = x[0];
    return 0;
}
int fmi3SetString(void *s, const unsigned *r, size_t n, const char **x, size_t m) {
    strncpy(((Self *)s)->now.label, x[0], 79);
    return 0;
}
int fmi3DoStep(void *s, double t, double h, bool final, bool *event, bool *end, bool *early, double *last) {
    *event = *early = false;
    *end = ((Self *)s)->now.mood == 9 && t >= ((Self *)s)->now.at;
    *last = t + h;
    return step(s, t, h);
}
int fmi3GetFMUState(void *s, void **state) {
    *state = malloc(sizeof(Values)); memcpy(*state, &((Self *)s)->now, sizeof(Values)); return 0;
}
int fmi3SetFMUState(void *s, void *state) { memcpy(&((Self *)s)->now, state, sizeof(Values)); return 0; }
int fmi3FreeFMUState(void *s, void **state) { free(*state); *state = NULL; return 0; }
int fmi3SerializedFMUStateSize(void *s, void *state, size_t *size) { *size = sizeof(Values); return 0; }
int fmi3SerializeFMUState(void *s, void *state, unsigned char *data, size_t size) {
    memcpy(data, state, size); return 0;
}
int fmi3DeserializeFMUState(void *s, const unsigned char *data, size_t size, void **state) {
    *state = malloc(sizeof(Values)); memcpy(*state, data, size); return 0;
}
"""
LOG = {
    2: "typedef void (*Log)(void *, const char *, int, const char *, const char *, ...);",
    3: "typedef void (*Log)(void *, int, const char *, const char *);",
}
SAY = {
    2: 's->log(s->environment, "vehicle", status, "logStatusError", "%s (%d)", text, status)',
    3: 's->log(s->environment, status, "logStatusError", text)',
}
CALLBACKS = "typedef struct { Log log; void *allocate, *release, *finished, *environment; } Callbacks;"


def c_fmu(folder: Path, version: int = 2, capabilities: str = "", describe: Callable[[str], str] = str) -> Path:
    """Build an FMU of C.

    Args:
        folder: for it.
        version: of FMI, 2 or 3.
        capabilities: what it can do, as attributes of its description.
        describe: changes its description.
    """
    from fmpy import platform, platform_tuple, sharedLibraryExtension

    library = folder / f"vehicle{version}{sharedLibraryExtension}"
    if not library.exists():
        _compile(library, version)
    file = folder / f"vehicle{version}-{abs(hash((capabilities, describe(''))))}.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        where = platform if version == 2 else platform_tuple
        archive.write(library, f"binaries/{where}/vehicle{sharedLibraryExtension}")
        text = description2(capabilities) if version == 2 else description3(capabilities)
        archive.writestr("modelDescription.xml", describe(text))
    return file


def _compile(library: Path, version: int) -> None:
    """Compile the library; functions that it does without are there, and fail."""
    from fmpy.fmi2 import FMU2Slave
    from fmpy.fmi3 import FMU3Slave

    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("no compiler for C here, of which the FMUs of these tests are made")
    functions = FMI2 if version == 2 else FMI3
    starts = " ".join(f"a->{c} = {start};" for _, _, c, _, _, start in REALS if start is not None)
    cases = " ".join(f"case {reference}: return &s->now.{c};" for reference, _, c, *_ in REALS)
    body = C.replace("@STATE@", STATE).replace("@STARTS@", starts).replace("@CASES@", cases)
    say = f"static void say(void *self, int status, const char *text);\n{body}"
    say += f"static void say(void *self, int status, const char *text) {{ Self *s = self; {SAY[version]}; }}\n"
    names = [name for name, _ in inspect.getmembers(FMU2Slave if version == 2 else FMU3Slave)]
    needed = [name for name in names if name.startswith(f"fmi{version}") and f"{name}(" not in functions]
    stubs = "\n".join(f"int {name}() {{ return 3; }}" for name in needed)
    source = library.with_suffix(".c")
    source.write_text("\n".join([LOG[version], say, CALLBACKS, functions, stubs]))
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-w", "-o", library, source, "-lm"], check=True)


def description2(capabilities: str = "") -> str:
    """The description of the FMU of FMI 2.0."""
    rows = []
    for reference, name, _, causality, variability, start in REALS:
        given = "" if start is None else f' start="{start}"'
        initial = ' initial="exact"' if start is not None and causality == "local" else ""
        initial = ' initial="exact"' if variability == "constant" else initial
        limit = ' min="0.001"' if name == "mass" else ""
        rows.append(
            f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
            f'variability="{variability}"{initial}><Real{given}{limit}/></ScalarVariable>'
        )
    head = 'causality="parameter" variability="fixed"'
    rows += [
        f'<ScalarVariable name="mood" valueReference="{MOOD}" {head}><Enumeration declaredType="Mood" start="0"/>'
        "</ScalarVariable>",
        f'<ScalarVariable name="eager" valueReference="{EAGER}" {head}><Boolean start="false"/></ScalarVariable>',
        f'<ScalarVariable name="label" valueReference="{LABEL}" {head}><String start=""/></ScalarVariable>',
        '<ScalarVariable name="count" valueReference="20" causality="output" variability="discrete"><Integer/>'
        "</ScalarVariable>",
    ]
    items = "".join(f'<Item name="{mood}" value="{number}"/>' for number, mood in enumerate(MOODS))
    return (
        '<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="2.0" modelName="vehicle" guid="right">'
        f'<CoSimulation modelIdentifier="vehicle" {capabilities}/>'
        f'<TypeDefinitions><SimpleType name="Mood"><Enumeration>{items}</Enumeration></SimpleType></TypeDefinitions>'
        f"<ModelVariables>{''.join(rows)}</ModelVariables><ModelStructure/></fmiModelDescription>"
    )


def description3(capabilities: str = "") -> str:
    """The description of the FMU of FMI 3.0."""
    rows = []
    for reference, name, _, causality, variability, start in REALS:
        given = "" if start is None else f' start="{start}"'
        initial = ' initial="exact"' if start is not None and causality in ("local", "output") else ""
        rows.append(
            f'<Float64 name="{name}" valueReference="{reference}" causality="{causality}" '
            f'variability="{variability}"{initial}{given}/>'
        )
    head = 'causality="parameter" variability="fixed"'
    rows += [
        f'<Enumeration name="mood" valueReference="{MOOD}" {head} declaredType="Mood" start="0"/>',
        f'<Boolean name="eager" valueReference="{EAGER}" {head} start="false"/>',
        f'<String name="label" valueReference="{LABEL}" {head}><Start value=""/></String>',
        '<Float64 name="row" valueReference="20" causality="output"><Dimension start="3"/></Float64>',
    ]
    items = "".join(f'<Item name="{mood}" value="{number}"/>' for number, mood in enumerate(MOODS))
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        '<fmiModelDescription fmiVersion="3.0" modelName="vehicle" instantiationToken="right">'
        f'<CoSimulation modelIdentifier="vehicle" {capabilities}/>'
        f'<TypeDefinitions><EnumerationType name="Mood">{items}</EnumerationType></TypeDefinitions>'
        f"<ModelVariables>{''.join(rows)}</ModelVariables><ModelStructure/></fmiModelDescription>"
    )


PYTHON = """
import os
import time

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real, String


class Vehicle(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.height = self.velocity = self.force = 0.0
        self.mass, self.mood = 10.0, "good"
        for name in ("height", "velocity"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        self.register_variable(Real("force", causality=Fmi2Causality.output))
        parameter = dict(causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
        self.register_variable(Real("mass", **parameter))
        self.register_variable(String("mood", **parameter))

    def exit_initialization_mode(self):
        self.force = FACTOR * self.mass * 9.81

    def do_step(self, current_time, step_size):
        if self.mood == "raise":
            raise ValueError("the wheel fell off")
        if self.mood == "refuse":
            self.log("not today")
            return False
        if self.mood == "nan":
            self.force = float("nan")
            return True
        if self.mood == "hang":
            time.sleep(1000.0)
        if self.mood == "loop":
            while True:
                pass
        if self.mood == "exit":
            os._exit(7)
        if self.mood == "abort":
            os.abort()
        if self.mood == "print":
            print("the FMU prints")
        self.force = FACTOR * self.mass * 9.81 + 1000.0 * self.height + 10.0 * self.velocity
        return True
"""


def python_fmu(folder: Path, factor: float = 1.0, **options: Any) -> Path:
    """Build an FMU of Python; all of them have a module of the same name."""
    builder = pytest.importorskip("pythonfmu.builder", reason="pythonfmu builds the FMUs of these tests")
    if not builder.FmuBuilder.has_binary():
        pytest.skip("pythonfmu has no binary for this platform")
    folder.mkdir(exist_ok=True)
    script = folder / "vehicle.py"
    script.write_text(PYTHON.replace("FACTOR", str(factor)))
    flags = [f"--{option.replace('_', '-')}" for option, wanted in options.items() if wanted]
    subprocess.run(  # not here: pythonfmu would leave the folder and the module behind
        [sys.executable, "-m", "pythonfmu", "build", "-f", "vehicle.py", "-d", "vehicle.fmu", *flags],
        cwd=folder, check=True, capture_output=True,
    )  # fmt: skip
    return folder / "vehicle.fmu"


class StillLine:
    """A line in the plane of which every point stands at a height given over time, sloping along x."""

    def __init__(self, height: Callable[[float], float] = lambda t: 0.0, length: float = 10.0) -> None:
        self.length, self.height, self.t = length, height, 0.0
        self.slope, self.stretch, self.forces = 0.0, 1.0, {0: (0.0, 0.0), 1: (0.0, 0.0)}

    def at(self, xi: float) -> tuple[Any, Any]:
        """Place and velocity."""
        d = 1e-6
        rate = (self.height(self.t + d) - self.height(self.t - d)) / (2.0 * d)
        return np.array([2.0 + self.stretch * xi, self.height(self.t) + self.slope * xi]), np.array([0.0, rate])

    def below(self, x: float) -> float:
        """The xi under x, no further than its ends."""
        return min(max((x - 2.0) / self.stretch, 0.0), self.length)

    def force(self, number: int = 0) -> Any:
        """As the test says."""
        return self.forces[number]
