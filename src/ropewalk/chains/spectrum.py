"""The spectrum of plain ropes, and the state of a motion at an instant."""

from __future__ import annotations

import numpy as np

from ropewalk.chains.beginning import initial_state
from ropewalk.chains.moving import Chain
from ropewalk.errors import EquilibriumError, RopewalkError
from ropewalk.external.cosimulation_master import closing
from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import OFF, ChainState
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.results.spectrum import Spectrum
from ropewalk.solve.chain_equations import equations_of, hang_down
from ropewalk.solve.free_vibration import free_vibration
from ropewalk.solve.initial_loads import place_loads
from ropewalk.solve.spectrum import in_space, spectrum
from ropewalk.solve.splitting import RUNNING
from ropewalk.solve.start import PreparedRun, setting_of, start_state
from ropewalk.solve.vehicle_statics import resting_forces


def state_at(scenario: Scenario, t: float) -> tuple[PreparedRun, ChainState, Bodies | None]:
    """The model of a dynamic run, its state at time t in s, and all that has a mass.

    Raises:
        RopewalkError: the run does not come to the instant.
    """
    assert isinstance(scenario.run, Dynamic)
    if t <= 0.0:
        setting = setting_of(scenario, scenario.run.until)
        return setting, *initial_state(setting, scenario)
    chain = Chain(scenario, RunInfo(), np.array([t]))
    with closing(chain.cosimulation):
        chain.motion.to(t)
    if chain.progress.status != RUNNING:
        outcome, advice = chain.progress.ending()
        raise RopewalkError(f"the run did not reach t = {t:g} s ({outcome}): {advice}")
    return chain.setting, chain.state, chain.bodies


def spectrum_of(scenario: Scenario, at: float | None, how_many: int | None, *, with_loads: bool) -> Spectrum:
    """The spectrum of plain ropes at an instant in s, or at rest."""
    bodies: Bodies | None = None
    if at is not None:
        setting, state, bodies = state_at(scenario, at)
    elif with_loads:
        setting = setting_of(scenario, 0.0)
        state = start_state(setting, True, resting_forces(setting.loading))
        if setting.multibody_system is not None:
            bodies = place_loads(setting, state, True)
            assert bodies is not None
            hang_down(setting, state, bodies)
    else:
        setting = setting_of(scenario, 0.0)
        rests = [rest for rest in setting.bare if rest is not None]
        if len(rests) < len(setting.bare):
            name = setting.lines[setting.bare.index(None)]
            raise EquilibriumError(
                f"line {name}: without loads its equilibrium is not determined; write an instant of the run (--at) "
                "instead"
            )
        state = start_state(setting, False)
        state.moving_load[:] = OFF
        state.r[:] = np.concatenate([rest.position for rest in rests], axis=1)
        state.X[:] = np.concatenate([rest.X for rest in rests])
    if bodies is not None or setting.supports.free.any():
        return free_vibration(equations_of(scenario, setting, state, bodies), how_many)
    return spectrum(setting.strands, (in_space(state.r), state.X), how_many=how_many, names=setting.lines)
