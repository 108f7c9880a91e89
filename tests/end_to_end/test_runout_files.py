"""Files of a run-out study: barriers, trajectories, maps and the page; and that the
study's numbers are what they were without them."""

import csv
import json
import re
from unittest.mock import Mock

import numpy as np
import pyogrio
import pyproj
import pytest
from error_messages import assert_one_line_error
from slope_study import FAR, SLOPE, assert_refused
from text_files import rows_of, write_changed

import jaximpact.runout.study.output as output_module
from jaximpact import read_netcdf
from jaximpact.cli import main
from jaximpact.io.files import write_text
from jaximpact.runout import Ending, passages, read_slope_study, run_slope_study
from jaximpact.runout.study import drawing, map_files, page_data
from jaximpact.runout.study.intervals import percentile_interval
from jaximpact.runout.study.report_page import slope_report, unknowns
from jaximpact.runout.study.run_study import simulate

pytestmark = pytest.mark.slow

PLACE = 'origin = [2600000, 1200000]\nazimuth_deg = 90\ncrs = "EPSG:2056"\n'
PLAIN = SLOPE[: SLOPE.index("[[barriers]]")].replace(PLACE, "")
PLAIN = PLAIN.replace("export_trajectories = 70\n", "")
ON_MAP = ("trajectories.geojson", "stops.geojson", "collectors.geojson", "maps.gpkg")


def layer(folder, name):
    return json.loads((folder / f"{name}.geojson").read_text(encoding="utf-8"))


def test_the_study_is_the_same_without_barriers_and_maps(slope_results, tmp_path):
    _, _, with_all, *_ = slope_results
    path = tmp_path / "slope.toml"
    path.write_text(PLAIN)
    plain = run_slope_study(read_slope_study(path))
    assert not [name for name in plain.variables if "barrier" in str(name)]
    for name, values in plain.items():
        np.testing.assert_array_equal(values, with_all[name])


def test_barriers_count_first_passages(slope_results):
    folder, study, dataset, *_ = slope_results
    runs = simulate(study, np.arange(90))
    rows = rows_of(folder / "barriers.csv")
    for barrier in study.settings.barriers:
        found = passages(runs, barrier.x)
        blocks, first = np.unique(found.trajectory, return_index=True)
        over = found.lowest_height[first] > barrier.height
        broken = ~over & (found.energy[first] > barrier.capacity)
        mine = {r["quantity"]: r for r in rows if r["barrier"] == barrier.name}
        for name, count in (
            ("arriving", len(blocks)),
            ("over_of_all", over.sum()),
            ("broken_of_all", broken.sum()),
            ("stopped_of_all", np.sum(~over & ~broken)),
        ):
            row = mine[f"share_{name}"]
            assert (int(row["count"]), int(row["blocks"])) == (count, 90)
            assert float(row["value"]) == count / 90
            assert float(row["low"]) <= count / 90 <= float(row["high"])
        assert mine["share_over_of_arriving"]["blocks"] == str(len(blocks))
        energies = 1e-3 * found.energy[first]
        row = mine["energy_kJ_p95"]
        assert float(row["value"]) == pytest.approx(np.percentile(energies, 95))
        ends = [float(row["low"]), float(row["high"])]
        np.testing.assert_allclose(ends, percentile_interval(energies, 95))
        # 90 blocks are too few for the upper end at 99 %.
        assert mine["energy_kJ_p99"]["high"] == "nan"
    # All four effects occur.
    assert len(np.unique(dataset.barrier_effect.values)) == 4
    said = json.loads((folder / "manifest.json").read_text())["barriers"]
    assert [b["name"] for b in said] == [b.name for b in study.settings.barriers]
    assert said[0]["estimates"]["energy_kJ_p99"]["high"] is None


def estimates_of_first(dataset):
    """What the manifest says of the first barrier."""
    barriers = output_module.barriers_in_json(output_module.estimates_of(dataset))
    return barriers[0]["estimates"]


def test_failed_blocks_are_in_no_share(slope_results):
    _, _, dataset, *_ = slope_results
    dataset = dataset.copy(deep=True)
    arrived = dataset.barrier_effect.values[:, 0] != "not reached"
    dataset["ending"] = dataset.ending.astype("U12")
    dataset.ending.values[np.flatnonzero(arrived)[:5]] = str(Ending.failed)
    first = estimates_of_first(dataset)["share_arriving"]
    assert (first["count"], first["blocks"]) == (arrived.sum() - 5, 85)


def test_collectors_have_intervals(slope_results):
    folder, _, dataset, *_ = slope_results
    for row in rows_of(folder / "collectors.csv"):
        place = float(row["collector_m"])
        values = dataset[f"passage_{row['quantity']}"].sel(collector=place).values
        for percent in (50, 90, 95, 99):
            low, high = percentile_interval(values, percent)
            assert row[f"p{percent}_low"] == str(low)
            assert row[f"p{percent}_high"] == str(high)


def test_trajectories_in_files_are_those_of_the_study(slope_results):
    folder, study, dataset, *_ = slope_results
    table = np.genfromtxt(folder / "trajectories.csv", delimiter=",", names=True)
    assert set(table["block"]) == set(range(70))
    lines = layer(folder, "trajectories")["features"]
    assert [line["properties"]["block"] for line in lines] == list(range(70))
    runs = simulate(study, np.arange(70))
    for block in (0, 49, 50, 69):  # on both sides of a portion's end
        mine = table[table["block"] == block]
        path = runs.path(block, map_files.SPACING)
        np.testing.assert_allclose(mine["x_m"], path["x"], rtol=1e-11, atol=1e-9)
        assert np.all(np.diff(mine["time_s"]) >= 0.0)
        # Twelve digits of the file.
        assert mine["x_m"][-1] == pytest.approx(dataset.x_m.values[block], rel=1e-11)
        most = dataset.max_energy_J[block] * (1.0 + 1e-9)
        assert mine["kinetic_energy_J"].max() <= most
        # The profile runs due east.
        np.testing.assert_allclose(mine["easting_m"], 2600000.0 + mine["x_m"])
        np.testing.assert_allclose(mine["northing_m"], 1200000.0, atol=1e-6)
        positions = np.array(lines[block]["geometry"]["coordinates"])
        assert positions[-1, 2] == pytest.approx(dataset.y_m.values[block], abs=6e-4)
        assert np.all(np.any(np.diff(positions, axis=0) != 0.0, axis=1))
        properties = lines[block]["properties"]
        assert properties["max_energy_J"] == float(dataset.max_energy_J[block])
        assert properties["ending"] == str(dataset.ending.values[block])


def test_ends_and_collectors_on_the_map(slope_results):
    folder, study, dataset, *_ = slope_results
    stops = layer(folder, "stops")["features"]
    assert len(stops) == 90
    degrees = np.transpose([f["geometry"]["coordinates"] for f in stops])
    to_metres = pyproj.Transformer.from_crs(4326, 2056, always_xy=True)
    easting, northing = to_metres.transform(*degrees[:2])
    # Positions in millimetres; there and back without heights is off by as much again.
    np.testing.assert_allclose(easting - 2600000.0, dataset.x_m, rtol=0.0, atol=2e-3)
    np.testing.assert_allclose(northing, 1200000.0, rtol=0.0, atol=2e-3)
    places = layer(folder, "collectors")["features"]
    kinds = [f["properties"]["kind"] for f in places]
    assert kinds == ["collector"] * 2 + ["barrier"] * 2
    assert places[2]["properties"]["name"] == "upper, fence"
    assert places[2]["properties"]["capacity_kJ"] == 20.0
    assert places[0]["properties"]["capacity_kJ"] is None
    # On the ground.
    for feature in places:
        x, y = feature["properties"]["x_m"], feature["geometry"]["coordinates"][2]
        assert y == pytest.approx(study.profile.height(x), abs=6e-4)
    estimates = estimates_of_first(dataset)
    for name in ("share_over_of_all", "energy_kJ_p95"):
        assert places[2]["properties"][name] == estimates[name]["value"]


def test_other_programs_read_the_maps(slope_results):
    folder, *_ = slope_results
    for name in ("trajectories", "stops", "collectors"):
        package = pyogrio.read_info(folder / "maps.gpkg", layer=name)
        alone = pyogrio.read_info(folder / f"{name}.geojson")
        # WGS 84 with heights.
        assert (package["crs"], alone["crs"]) == ("EPSG:2056", "EPSG:4979")
        assert package["features"] == alone["features"] > 0
        assert package["geometry_type"] == alone["geometry_type"]
        assert list(package["fields"]) == list(alone["fields"])
        *_, values = pyogrio.raw.read(folder / "maps.gpkg", layer=name)
        *_, equal = pyogrio.raw.read(folder / f"{name}.geojson")
        for ours, theirs in zip(values, equal, strict=True):
            assert ours.tolist() == pytest.approx(theirs.tolist(), nan_ok=True)


def test_a_block_that_failed_has_no_place(slope_results, tmp_path):
    _, study, dataset, *_ = slope_results
    dataset = dataset.copy(deep=True)
    dataset.x_m.values[3] = np.nan
    first = simulate(study, np.arange(70))
    map_files.write_map_files(study, dataset, first, lambda name: tmp_path / name)
    features = layer(tmp_path, "stops")["features"]
    assert features[3]["geometry"] is None
    assert features[3]["properties"]["x_m"] is None
    assert len(features) == 90


def test_a_study_without_a_place_barriers_and_collectors(slope, tmp_path, capsys):
    slope.write_text(PLAIN.replace("collectors_m = [40, 60]\n", ""))
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    assert "Collectors" not in capsys.readouterr()[0]
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert not names & {*ON_MAP, "barriers.csv", "collectors.csv"}
    dataset = read_netcdf(tmp_path / "out" / "blocks.nc")
    assert "collector" not in dataset.dims
    assert dataset.sizes["block"] == 90
    with open("out/trajectories.csv", newline="") as file:
        assert "easting_m" not in next(csv.reader(file))
    assert "No file for maps is written" in (tmp_path / "out/report.html").read_text()


@pytest.mark.parametrize("name", ["report.html", "maps.gpkg"])
def test_nothing_of_others_is_replaced(slope, tmp_path, capsys, name):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / name).write_text("mine")
    assert_refused(capsys, f"has {name}")
    assert (tmp_path / "out" / name).read_text() == "mine"


def test_an_input_is_not_replaced(slope, tmp_path, capsys):
    (tmp_path / "trajectories.csv").write_text("x_m,y_m\n0,50\n80,0\n200,0\n")
    points = "points_m = [[0, 50], [50, 20], [55, 20], [80, 0], [200, 0]]"
    write_changed(slope, SLOPE, (points, 'csv = "trajectories.csv"'))
    assert main(["runout", "slope.toml", "--out", "."]) == 2
    assert_one_line_error(capsys, "trajectories.csv", "which is read")


@pytest.mark.parametrize(
    ("module", "name", "error", "message"),
    [
        # In the second portion of trajectories, while three files are open.
        (map_files, "simulate", KeyboardInterrupt, "the same command goes on"),
        (map_files, "simulate", OSError("disk full"), "error: disk full"),
        (
            *(drawing, "draw_stops", RuntimeError("no font\nat all")),
            "error: no file was written: RuntimeError: no font\\nat all",
        ),
    ],
)
def test_writing_that_breaks_off_leaves_no_half(
    slope, tmp_path, monkeypatch, capsys, module, name, error, message
):
    with monkeypatch.context() as patch:
        patch.setattr(module, name, Mock(side_effect=error))
        assert main(["runout", "slope.toml", "--out", "out"]) != 0
    assert_one_line_error(capsys, message)
    left = {path.name for path in (tmp_path / "out").iterdir()}
    assert left == {"jaximpact-study.json", "blocks.journal"}
    if error is KeyboardInterrupt:
        # What the same command does where it goes on
        assert main(["runout", "slope.toml", "--out", "out"]) == 0
        names = {path.name for path in (tmp_path / "out").iterdir()}
        assert names >= {*ON_MAP, "trajectories.csv", "report.html", "stops.png"}


# --- The page.


def data_of(page):
    return json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])


def test_the_page_needs_nothing_else(slope_results):
    page = (slope_results[0] / "report.html").read_text(encoding="utf-8")
    assert not re.findall(r"(?:src|href)\s*=|url\(|@import|fetch\(", page)
    # Names of XML are no addresses that are read.
    assert {*re.findall(r"https?://[^\s\"']+", page)} <= {"http://www.w3.org/2000/svg"}
    assert page.count("<script") == page.count("</script>") == 3


def test_curves_of_the_page_are_those_of_the_blocks(slope_results):
    folder, _, dataset, *_ = slope_results
    data = data_of((folder / "report.html").read_text(encoding="utf-8"))
    assert data["blocks"] == 90
    assert data["counts"] == dataset.blocks_in_bin.values.tolist()
    names = ("height_m", "speed_mps", "energy_J")
    for name, quantity in zip(names, data["quantities"], strict=True):
        factor = 1e-3 if name == "energy_J" else 1.0
        largest = 0.0
        for place, values in enumerate(quantity["values"]):
            blocks = factor * dataset[f"{name}_in_bin"].values[:, place]
            blocks = np.sort(blocks[np.isfinite(blocks)])[::-1]
            # Four digits are kept.
            ranks = np.array(data["ranks"][place], int)
            np.testing.assert_allclose(values, blocks[ranks - 1], rtol=6e-4)
            largest = max([largest, *values])
            if len(blocks):
                found = np.array(quantity["percentiles"][place], float)
                np.testing.assert_allclose(
                    found[:, 0], np.percentile(blocks, [50, 90, 95, 99]), rtol=6e-4
                )
                assert np.isnan(found[-1, 2])  # an upper end takes 368 blocks
        assert largest == pytest.approx(
            factor * float(dataset[f"max_{name}"].max()), rel=6e-4
        )


def test_the_page_names_pictures_that_there_are(slope_results, tmp_path):
    with_collectors = (slope_results[0] / "report.html").read_text(encoding="utf-8")
    assert "collectors.png and envelopes.png" in with_collectors
    (tmp_path / "far.toml").write_text(FAR.replace("collectors_m = [2600029]", ""))
    assert (
        main(["runout", str(tmp_path / "far.toml"), "--out", str(tmp_path / "o")]) == 0
    )
    page = (tmp_path / "o/report.html").read_text(encoding="utf-8")
    pictures = {*re.findall(r"[\w]+\.png", page)}
    assert pictures == {"envelopes.png"}
    assert pictures <= {file.name for file in (tmp_path / "o").iterdir()}


def test_places_of_a_page_in_national_coordinates(tmp_path):
    (tmp_path / "far.toml").write_text(FAR)
    study = read_slope_study(tmp_path / "far.toml")
    dataset = run_slope_study(study)
    page = slope_report(study, dataset, simulate(study, np.arange(3))).page()
    edges = data_of(page)["edges"]
    assert edges[:-1] == dataset.bin_left_m.values.tolist()
    assert edges[-1] == 2600730.0
    row = re.search(r"release_x_m</td>(.*?)</tr>", page, re.DOTALL)[1]
    least, median, largest = map(float, re.findall(r"<td[^>]*>([\d.]+)<", row))
    # To the decimetre.
    np.testing.assert_allclose(
        [least, median, largest],
        [f(study.release.x) for f in (np.min, np.median, np.max)],
        atol=0.051,
    )


def test_maxima_in_bins_are_those_of_the_envelopes(slope_results):
    _, _, dataset, *_ = slope_results
    for name in ("height_m", "speed_mps", "energy_J"):
        values = dataset[f"{name}_in_bin"].values
        here = np.any(np.isfinite(values), axis=0)
        largest = dataset[f"envelope_{name}_max"].values
        # Stored in single precision.
        np.testing.assert_allclose(np.nanmax(values[:, here], 0), largest[here], 1e-6)
        assert np.all(np.isnan(largest[~here]))


def test_paths_of_the_page_end_where_the_blocks_do(slope_results):
    """Curves of whole units, each relative to the end of the one before."""
    folder, study, dataset, *_ = slope_results
    page = (folder / "report.html").read_text(encoding="utf-8")
    scale = data_of(page)["scale"]
    ends = re.search(r'class="end" d="([^"]*)"', page)[1]
    ended = [int(x) for x in re.findall(r"M(-?\d+) ", ends)]
    np.testing.assert_allclose(
        scale["x"] + scale["unit"] * np.array(ended),
        dataset.x_m[:50],
        atol=scale["unit"],
    )
    reached = set()
    for path in re.findall(r'class="speed" style="[^"]*" d="([^"]*)"', page):
        at = None
        for x, y, curve in re.findall(r"(?:M(-?\d+) (-?\d+))?q([-\d ]+)", path):
            at = (int(x), int(y)) if x else at
            *_, dx, dy = map(int, curve.split())
            at = (at[0] + dx, at[1] + dy)
            reached.add(at[0])
    assert reached >= {*ended}
    assert study.inputs.title in page


def test_a_tall_barrier_near_the_release_is_drawn_whole(changed):
    """It stands higher than any block comes."""
    taller = ("x_m = 60\n", "x_m = 4\n"), ("height_m = 1\n", "height_m = 9\n")
    study = read_slope_study(changed(*taller))
    drawn = page_data.page_profile(study, simulate(study, np.arange(3)))
    path = drawn["barriers"][0]
    foot, top = map(int, re.fullmatch(r"M\d+ (\d+)V(\d+)", path).groups())
    scale = drawn["scale"]
    # A unit is 1 mm.
    assert (top - foot) * scale["unit"] == pytest.approx(9.0, abs=2e-3)
    assert top * scale["unit"] <= scale["height"] + 1e-3


def test_what_is_not_known_is_told(slope_results, slope):
    _, study, dataset, *_ = slope_results
    lines = " ".join(unknowns(study, dataset))
    for part in ("too few", "counted, not removed", "plane", "an assumption"):
        assert part in lines
    assert "No file for maps" not in lines
    dataset = dataset.copy()
    endings = {"failed": 3, "time limit": 2, "stopped": 85}
    dataset.attrs["endings"] = json.dumps(endings)
    lines = " ".join(unknowns(study, dataset))
    assert "3 blocks failed" in lines
    assert "2 blocks were cut off" in lines
    law = SLOPE[SLOPE.index("[contacts]") : SLOPE.index("[[barriers]]")]
    full = read_slope_study(write_changed(slope, SLOPE, (law, "")))
    assert "readings of the literature" in " ".join(unknowns(full, dataset))


def test_texts_of_users_are_only_text(slope_results, slope):
    _, study, dataset, *_ = slope_results
    evil = '</script><img src=x onerror="a()"> {{ 3 }} $x$'
    first, *others = study.settings.barriers
    barriers = (first._replace(name=evil), *others)
    study = study._replace(
        settings=study.settings._replace(barriers=barriers),
        inputs=study.inputs._replace(title=evil),
    )
    dataset = dataset.assign_coords(barrier=[b.name for b in barriers])
    runs = simulate(study, np.arange(3))
    page = slope_report(study, dataset, runs).page()
    assert "<img" not in page
    assert page.count("</script>") == 3
    assert data_of(page)["places"][2]["words"] == evil


def test_a_page_of_nothing(slope_results, slope):
    """All blocks are cut off at once, before any collector."""
    write_changed(slope, SLOPE, ("bins = 20", "bins = 1\ntime_limit_s = 1e-3"))
    study = read_slope_study(slope)
    dataset = run_slope_study(study)
    page = slope_report(study, dataset, simulate(study, np.arange(90))).page()
    assert data_of(page)["counts"] == [90]
    assert "No block stopped." in page


def test_a_large_study_makes_a_small_page(slope_results, tmp_path):
    """Of 10 000 blocks: 90 of them over again."""
    _, study, dataset, *_ = slope_results
    many = dataset.isel(block=np.arange(10_000) % 90)
    page = slope_report(study, many, simulate(study, np.arange(50))).page()
    write_text(tmp_path / "report.html", page)
    assert (tmp_path / "report.html").stat().st_size < 2e6


def test_too_many_letters_mean_fewer_trajectories(slope_results, monkeypatch):
    _, study, dataset, *_ = slope_results
    runs = simulate(study, np.arange(50))
    monkeypatch.setattr(page_data, "MOST_LETTERS", 2000)
    page = slope_report(study, dataset, runs).page()
    shown = int(re.search(r"The first (\d+) trajectories of 90", page)[1])
    assert 0 < shown < 50
    ends = re.search(r'class="end" d="([^"]*)"', page)[1]
    assert ends.count("M") == shown
