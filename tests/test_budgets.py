"""The project is not larger than its budgets, which only go down."""

from pathlib import Path

import pytest

from budgets import FILE, budgets, exceeded, limit, lowered, measured


@pytest.fixture(scope="module")
def values() -> dict[str, float]:
    return measured()


def test_no_budget_is_exceeded(values: dict[str, float]) -> None:
    assert not exceeded(values), "\n".join(exceeded(values))


@pytest.mark.parametrize("name", list(budgets()[1]))
def test_a_value_beyond_its_limit_is_found(name: str, values: dict[str, float]) -> None:
    stage, own = budgets()
    bound = limit(own[name], stage)
    beyond = {**values, name: -bound - 0.01 if bound < 0 else bound + 1}
    assert [line.partition(":")[0] for line in exceeded(beyond)] == [name]


def test_a_part_without_a_budget_is_found(values: dict[str, float]) -> None:
    assert exceeded({**values, "second engine": 1.0}) == [f"second engine: 1, and {FILE.name} has no budget"]


def test_only_engine_package_and_model_rise_with_a_stage() -> None:
    own = budgets()[1]
    rising = {
        name for name, budget in own.items() for stage in ("lines", "loads", "surfaces", "overhead_lines", "half")
        if limit(budget, stage) > limit(budget, "ground")
    }  # fmt: skip
    assert rising == {"engine", "package", "model"}
    assert limit(own["engine"], "ground") <= 54_200  # 51 000 were planned for its end
    assert max(limit(own["engine"], stage) for stage in ("ground", "lines", "loads", "surfaces")) == 59_000
    assert limit(own["model"], "lines") - limit(own["model"], "ground") == 1_000


def test_lowering_rewrites_ceilings_to_present_values_and_raises_none(tmp_path: Path, values: dict[str, float]) -> None:
    smaller = {name: 0.5 * value if value > 1 else 0.99 for name, value in values.items()}
    file = tmp_path / "budgets.yaml"
    file.write_text(lowered(FILE.read_text(encoding="utf-8"), smaller), encoding="utf-8")
    stage, found = budgets(file)
    _, before = budgets()
    for name, budget in found.items():
        if "ceiling" in budget:
            assert budget["ceiling"] == round(smaller[name])
        elif "floor" in budget:
            assert budget["floor"] == 0.99
        else:
            assert budget == before[name]
    larger = {name: 9.0 * value if value > 1 else 0.1 for name, value in values.items()}
    assert lowered(FILE.read_text(encoding="utf-8"), larger) == FILE.read_text(encoding="utf-8")
    assert stage == budgets()[0]
