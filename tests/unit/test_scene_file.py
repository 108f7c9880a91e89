"""One scene from TOML. What is refused is in test_malformed_inputs.py."""

import math
from pathlib import Path

import jax
import pytest

from jaximpact import Block, Impact, Scene, Soil
from jaximpact.errors import InputError
from jaximpact.io.toml import read_scene, scene_from


@pytest.fixture
def scene_of(tmp_path):
    """Writes text to scene.toml and reads it."""

    def read(content):
        path = tmp_path / "scene.toml"
        path.write_text(content)
        return read_scene(path)

    return read


def test_an_empty_file_is_the_default_scene(scene_of):
    scene, accuracy = scene_of("")
    default = Scene(Block(), Soil(), Impact())
    assert jax.tree.leaves(scene) == jax.tree.leaves(default)
    assert accuracy is None


def test_tables_and_flat_keys_say_the_same(scene_of):
    nested = scene_of(
        'accuracy = "fast"\n[block]\nmass_kg = 3\n[soil]\nunit_weight_kNm3 = 20\n'
        "[impact]\nangle_deg = -45.0\n"
    )
    flat = scene_of(
        'accuracy = "fast"\nmass_kg = 3\nunit_weight_kNm3 = 20\nangle_deg = -45.0\n'
    )
    assert jax.tree.leaves(nested) == jax.tree.leaves(flat)
    assert nested.accuracy == "fast"
    assert float(nested.scene.block.mass) == 3.0
    assert float(nested.scene.soil.unit_weight) == 20e3
    assert float(nested.scene.impact.angle) == pytest.approx(-math.pi / 4, rel=1e-15)


def test_a_scene_that_cannot_be_read_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"none\.toml: cannot be read: No such file"):
        read_scene(tmp_path / "none.toml")
    with pytest.raises(InputError, match="cannot be read: Is a directory"):
        read_scene(tmp_path)


def test_a_scene_may_be_part_of_a_file():
    path = Path("study.toml")
    content = {"mass_kg": 3, "axes": {"angle_deg": [0, 1]}}
    scene, _ = scene_from(path, content, others=("axes",))
    assert float(scene.block.mass) == 3.0
    with pytest.raises(InputError, match="key axis: is unknown; did you mean axes"):
        scene_from(path, {"axis": {}}, others=("axes",))
