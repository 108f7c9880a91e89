"""One scene from TOML: what is read and what is refused."""

import math
from pathlib import Path

import jax
import pytest
from error_messages import assert_one_line

from jaximpact import Block, Impact, Scene, Soil
from jaximpact.errors import InputError
from jaximpact.io.toml import read_scene, scene_from


@pytest.fixture
def scene_of(tmp_path):
    """Writes bytes or text to scene.toml and reads it."""

    def read(content):
        path = tmp_path / "scene.toml"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
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


REFUSED = {
    "syntax": ("mass_kg = \n", ["not valid TOML", "line 1"]),
    "twice": ("mass_kg = 1\nmass_kg = 2\n", ["not valid TOML", "line 2"]),
    "encoding": (b"# \xe4\n", ["UTF-8"]),
    "unknown-flat": ("mas_kg = 1\n", ["key mas_kg", "mass_kg?"]),
    "unknown-nested": ("[soil]\nk_e = 1\n", ["key soil.k_e", "k_E?"]),
    "unknown-table": ("[sol]\nk_E = 1\n", ["key sol", "soil?"]),
    "misspelt-accuracy": ('acuracy = "fast"\n', ["key acuracy", "accuracy?"]),
    "wrong-table": ("[soil]\nmass_kg = 1\n", ["mass_kg", "[soil]", "[block]"]),
    "both": ("mass_kg = 1\n[block]\nmass_kg = 1\n", ["mass_kg", "remove one"]),
    "no-table": ("block = 1\n", ["key block", "table"]),
    "text": ('[block]\nmass_kg = "1"\n', ["mass_kg", "a number", "'1'"]),
    "boolean": ("mass_kg = true\n", ["mass_kg", "a number", "True"]),
    "list": ("mass_kg = [1, 2]\n", ["mass_kg", "a number"]),
    "negative": ("mass_kg = -1\n", ["mass_kg", "above 0 kg", "-1"]),
    "nan": ("orientation_deg = nan\n", ["orientation_deg", "finite", "nan"]),
    "grazing": ("[impact]\nangle_deg = 90\n", ["angle_deg", "(-90, 90) deg", "90"]),
    "accuracy": ('accuracy = "exact"\n', ["key accuracy", "reference", "'exact'"]),
    "accuracy-type": ("accuracy = [1]\n", ["key accuracy", "fast"]),
}


@pytest.mark.parametrize(("content", "needed"), REFUSED.values(), ids=REFUSED)
def test_bad_scenes_are_refused_in_one_line_that_says_where(scene_of, content, needed):
    with pytest.raises(InputError) as caught:
        scene_of(content)
    assert_one_line(caught.value, "scene.toml", *needed)


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
