"""`jaximpact runout`: slope run-out of many blocks."""

import argparse
import textwrap
from functools import partial
from pathlib import Path

from ..interruption import resumable
from ..progress_lines import ProgressLines, say
from . import options

STUDY = """\
Release many blocks on a slope, and report where they stop and what passes.

The study is a TOML file. Lengths in m, angles in degrees; x to the right, y up.

    collectors_m = [380, 450]      # places at which passages are recorded

    [profile]                      # from left to right; or csv = "profile.csv"; or
    points_m = [[0, 230], [400, 0], [1000, 0]]      # dxf = "slope.dxf", layer = "..."

    [ground]                       # quantities of the soil, for the whole slope
    gamma_v = { mean = 8.7, sd = 2, least = 1 }
    rolling_friction_angle_deg = 20
    roughness_deg = 3              # standard deviation of the local slope
    [ground.materials.meadow]      # what is different from one x to another; or
    from_x_m = 380                 # [ground.segment.2], on the second segment
    to_x_m = 1000
    c_v = { from = 0.4, to = 0.6, correlation_length_m = 20 }

    [block]
    mass_kg = { mean = 100, sd = 30, least = 20 }   # or volume_m3
    shape = "RectangularPrism"     # default: "Ellipsoid"; or a list of shapes
    corner_radius_ratio = [0.1, 0.5]

    [release]
    x_m = 2                        # or along_x_m = [2, 40], a line; see below
    clearance_m = 1                # vertical gap below the block; or y_m, its centre
    speed_mps = 20                 # with direction_deg; or v_x_mps and v_y_mps
    direction_deg = { from = 0, to = 20 }
    angular_velocity_degps = [0, 2500, 5000]

    [contacts]                     # default: law = "full model"
    law = "constant coefficients"
    e_n = 0.35
    e_t = 0.85

    [[barriers]]                   # as many as you like
    name = "fence"                 # default: its place
    x_m = 450
    height_m = 4                   # of its top above the ground, vertically
    capacity_kJ = 1000             # kinetic energy that it stops

A quantity of ground, block or release is a number, a list or a distribution:
  { mean, sd }                  normal
  { from, to }                  uniform
  { median, geometric_sd }      lognormal: two thirds lie between median / geometric_sd
                                and median x geometric_sd
  { exponent, least, most }     power law: the number of blocks larger than x goes with
                                x^-exponent; some 0.5 for volumes of rockfalls
The normal and the lognormal one take least and most too, which truncate them. A
distribution is sampled once per block, and so is the ground: a block finds one c_v
wherever it goes, or one on each segment or material that has its own. Lists make every
combination, those of the ground slowest, the last one fastest, and over again until
there are enough blocks.
A quantity of the ground with correlation_length_m beside its distribution varies along
the slope: a random field for each block, of that distribution at each place, with the
correlation exp(-distance along x / length).
volume_m3 stands in place of mass_kg: the mass is density_kgm3 times the volume.
along_x_m = [from, to] stands in place of x_m: blocks are released anywhere between two
x, uniformly by length along the ground, or with spacing_m at this distance along the
ground from one place to the next. x_m = { from, to } is uniform in x.

A profile's CSV has the columns x_m and y_m; any quantity of the soil,
rolling_friction_angle_deg and roughness_deg, which hold from their point to the next;
and material, which names a table [ground.materials.NAME] without from_x_m and to_x_m. A
DXF drawing (AutoCAD; needs the package ezdxf) has the profile as one polyline, or lines
and arcs that join, also in blocks, x to the right and y up, in metres or the unit that
it names; layer says on which layer, where there are several lines. Of a closed line the
upper part is the profile. What is invisible is passed over, and so is what is on a
layer that is off or frozen, unless layer names it.
[profile] may have smooth_m, which takes the noise of measurement out of the heights of
points some times closer: each becomes that of a parabola fitted to the points about it,
weighted by a Gaussian along x whose standard deviation is smooth_m. The report says by
how much heights move. Walls and steps are rounded off.
Materials must not overlap. Where none is, the quantities of [ground] hold, and a
warning says where; if it has none, such ground is refused.
What [ground] does not give has its default below; rolling_friction_angle_deg is 20,
an assumption, and roughness_deg 0.
[ground] may name laws of the soil, flow = "my_laws.py:MyFlow", and [block] a shape;
their parameters are then quantities like the others. The whole slope has the same laws.
kinematics is "WorkConjugate" if nothing is said, by which contacts give no block energy
that the ground cannot give; beside tables it is the paper's, "DeepestPoint". Elongated
blocks are run a second time by the other one, if contacts are by the full model, and
the report says which design values differ by more than their intervals.
[ground] may name a calibration, from = "out/wyllie", the directory that `jaximpact
calibrate` wrote, with variant = "..." where the study has several. Each block then gets
parameters of its own, sampled from the posterior with their correlations, and what the
fit held. A parameter that is not identifiable from the tests must be given beside it; a
parameter that is given is held there, and the others are sampled conditional on it.
With a roughness each impact meets the ground at an angle of its own, sampled from a
normal distribution about the segment's, cut off at 3 standard deviations; angles at
which the block would not strike are sampled again. No contact gains energy by it.
Touches too slow to be an impact, rolling and sliding see the segment as it is.
direction_deg goes from the horizontal upwards; orientation_deg from the vertical,
clockwise, to the major axis; clockwise is positive for angular_velocity_degps.
A barrier changes no trajectory: blocks that reach it, pass over it (lowest point above
its top), break it (energy above its capacity) or are stopped are counted, at their
first passage, with intervals of 95 %.
[profile] may have origin = [easting, northing] of x = 0, azimuth_deg, the direction of
x from north clockwise, and crs = "EPSG:2056" or another in metres: then trajectories,
stops, collectors and barriers are written for maps, as GeoJSON (longitude and latitude)
and GeoPackage. That takes further packages: pip install 'jaximpact[maps]'.

Further keys, before all tables:
  title          free text
  count          blocks (default: 1000, or the combinations if nothing is random)
  seed           of the random numbers (default: 0); block i gets the same ones whatever
                 the count, and whatever else is random
  accuracy       of the full model, as --accuracy
  bins           of x, for the envelopes (default: 50)
  export_trajectories
                 in files, the first ones (default: 50)
  time_limit_s, event_limit
                 where a block still under way is given up (defaults: 600 and 10000)
  hop_threshold  height of a low flight (hop), as a fraction of the height by which the
                 block's centre rises and falls as it rolls, below which it rolls
                 instead (default: 1; 0: each hop is a flight and an impact, some
                 hundreds for each elongated block)

"""
RESULT = """

Every block has an ending: stopped, left profile, time limit, event limit or failed. All
are counted; those that failed are left out of percentiles and curves. A summary is
printed. Written to DIR: report.html, a page to hand over, manifest.json, blocks.nc,
stops.csv, collectors.csv, barriers.csv, trajectories.csv, maps and drawings; where laws
are compared, for each law in a directory of its own, and tables and drawings that set
them side by side in DIR. After a run that was cut short the same command goes on from
there."""


def _description() -> str:
    from ..finding import shipped
    from ..quantities import own_columns
    from ..rebound import AbstractRebound

    laws = []
    for kind in shipped(AbstractRebound):
        names = ", ".join(column.name for column in own_columns(kind))
        laws.append(f"{kind.words} ({names})" if names else kind.words)
    in_words = textwrap.fill(
        "Contact laws: full model; table (files, of `jaximpact tabulate`, one for "
        f"each pair of block and ground); {'; '.join(laws)}; and one of your own, "
        'law = "my_rebound.py:MyLaw", with its parameters as keys. '
        "Several [[contacts]], each with a name if their laws do not tell them apart, "
        "are compared: the same blocks are released for each law.",
        88,
        break_on_hyphens=False,
    )
    return f"{STUDY}{in_words}\n{RESULT}"


def add_parser(commands) -> None:
    """Add the command to the command line."""
    parser = options.add_command(
        commands,
        "runout",
        run,
        help="slope run-out of many blocks",
        description=_description,
        epilog=lambda: options.input_help(
            "Quantities of ground and block, among others:"
        ),
    )
    parser.add_argument(
        "study", type=Path, metavar="slope.toml", help="profile, blocks and releases"
    )
    options.add_directory(parser, "report, tables and drawings")
    options.add_accuracy(parser, otherwise="the study's, else balanced")
    parser.add_argument(
        "--no-second-run",
        action="store_true",
        help="do not run elongated blocks again with the other kinematics of the soil",
    )
    options.add_engine(parser)


def run(arguments: argparse.Namespace) -> None:
    """Compute the study."""
    from ..io.files import make_directory
    from ..io.output_files import output_directory, together
    from ..runout import read_slope_studies, run_slope_study
    from ..runout.study import output

    studies = read_slope_studies(arguments.study, arguments.accuracy)
    several = len(studies) > 1
    folders = [Path(study.law.directory if several else "") for study in studies]
    names = [
        (f / name).as_posix()
        for f in folders
        for name in output.names_of_files(studies[0])
    ]
    if several:
        names += output.names_of_files(studies[0], comparison=True)
    datasets, journals = {}, []
    files = dict.fromkeys(file for study in studies for file in study.inputs.files)
    directory = output_directory(arguments.out, "runout", names, inputs=list(files))
    with resumable(), directory as new, options.engine_of(arguments) as executor:
        for study, folder in zip(studies, folders, strict=True):
            make_directory(arguments.out / folder, option="--out")
            journals.append(arguments.out / folder / "blocks.journal")
            if several:
                say(f"contacts by {study.law.name}")
            with ProgressLines() as progress:
                dataset = run_slope_study(
                    study,
                    journal=journals[-1],
                    progress=partial(progress, "blocks"),
                    executor=executor,
                    second_run=not arguments.no_second_run,
                )
            datasets[study.law.name] = dataset
        with together(new) as add:
            for study, folder in zip(studies, folders, strict=True):
                report = output.write_slope_study(
                    study,
                    datasets[study.law.name],
                    lambda name, folder=folder: add((folder / name).as_posix()),
                )
            if several:
                report = output.write_comparison(studies[0], datasets, add)
        for journal in journals:
            journal.unlink()
    print(report.text(), end="")
    say(f"tables and drawings written to {arguments.out}")
