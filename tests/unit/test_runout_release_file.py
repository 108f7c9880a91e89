"""Volumes of blocks, and releases along a line, as a study's file says them."""

import numpy as np
import pytest
from slope_study import CONSTANT, slope_text

from jaximpact.runout import read_slope_study

SLOPE = slope_text(
    top="count = 400\nseed = 7",
    profile="points_m = [[0, 80], [60, 0], [200, 0]]",
    block="volume_m3 = { exponent = 0.5, least = 0.01, most = 2 }",
    release="along_x_m = [30, 100]",
    contacts=CONSTANT,
)


def test_mass_is_density_times_volume(slope, changed):
    block = read_slope_study(slope).release.block
    volume = block.mass / block.density
    assert 0.01 <= volume.min() < 0.011
    assert 1.0 < volume.max() <= 2.0
    both = ("[block]", "[block]\ndensity_kgm3 = [2000, 3000]")
    block = read_slope_study(changed(both)).release.block
    # The same volumes, whatever the density.
    np.testing.assert_allclose(block.mass / block.density, volume, rtol=1e-15)
    assert set(block.density) == {2000.0, 3000.0}
    one = read_slope_study(
        changed(("{ exponent = 0.5, least = 0.01, most = 2 }", "0.5"))
    )
    np.testing.assert_array_equal(one.release.block.mass, 0.5 * 2577.8)


def test_a_line_is_uniform_along_the_ground(slope, changed):
    x = read_slope_study(slope).release.x
    # 30 m of x on the slope of 3:4:5 are 50 m of ground, 40 m on the flat are 40.
    along = np.where(x < 60.0, (x - 30.0) / 0.6, 50.0 + x - 60.0)
    assert 0.0 <= along.min() < 1.0
    assert 89.0 < along.max() <= 90.0
    # Five standard errors of the share of 400 blocks.
    assert np.mean(x < 60.0) == pytest.approx(5.0 / 9.0, abs=5.0 * 0.025)
    few = read_slope_study(changed(("count = 400", "count = 10")))
    np.testing.assert_array_equal(few.release.x, x[:10])


def test_a_line_at_equal_spacing(slope, changed):
    spaced = ("[30, 100]", "[30, 100]\nspacing_m = 15")
    x = read_slope_study(changed(spaced)).release.x
    expected = [30, 39, 48, 57, 70, 85, 100]
    np.testing.assert_allclose(x[:7], expected, rtol=1e-14)
    np.testing.assert_array_equal(x[7:14], x[:7])
    # Nothing random: a block for each place.
    changed(
        spaced,
        ("count = 400\n", ""),
        ("{ exponent = 0.5, least = 0.01, most = 2 }", "[0.1, 0.2]"),
    )
    release = read_slope_study(slope).release
    assert release.count == 14
    np.testing.assert_allclose(release.x[:7], expected)
    np.testing.assert_allclose(release.block.mass[:7], 257.78)


def test_blocks_of_a_line_have_their_clearance(changed):
    study = read_slope_study(changed(("[30, 100]", "[100, 150]")))
    radius = np.cbrt(
        study.release.block.mass / study.release.block.density * 0.75 / np.pi
    )
    np.testing.assert_allclose(study.release.y, 0.5 + radius, rtol=1e-12)
