"""The parts of the add-on for Blender that need no Blender: blender_parts_test.py ADDON TOOLS"""
import importlib
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest

import numpy as np

ADDON, TOOLS = map(pathlib.Path, sys.argv[1:3])
sys.dont_write_bytecode = True


def part(name):
    """A module of the package, whose __init__ is for Blender."""
    for package, folder in (("latent_render", ADDON), ("latent_render.export", ADDON / "export")):
        if package not in sys.modules:
            sys.modules[package] = types.ModuleType(package)
            sys.modules[package].__path__ = [str(folder)]
    return importlib.import_module(f"latent_render.{name}")


pbrt, ply, tools, job, develop = (part(name) for name in ("export.pbrt", "export.ply", "tools", "job", "develop"))
nodes, values, spectra, curves, ies = (part(f"export.{name}") for name in ("nodes", "values", "spectra", "curves", "ies"))


def tool(name, *words):
    return subprocess.run([TOOLS / f"latent-{name}", *map(str, words)], check=True, capture_output=True, text=True).stdout


class Text(unittest.TestCase):
    def test_a_directive_has_typed_parameters(self):
        self.assertEqual(pbrt.directive("Shape", "disk", **{"float radius": 0.5, "bool x": True, "rgb L": [1.0, 2.0, 0.25]}),
                         'Shape "disk" "float radius" 0.5 "bool x" true "rgb L" [ 1 2 0.25 ]')

    def test_a_name_cannot_end_its_string(self):
        self.assertEqual(pbrt.quoted('a"b\\c\nd'), "\"a'b/c d\"")

    def test_matrices_are_stored_by_columns(self):
        rows = [[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12], [0, 0, 0, 1]]
        self.assertEqual(pbrt.matrix(rows), "Transform [ 1 5 9 0 2 6 10 0 3 7 11 0 4 8 12 1 ]")

    def test_equal_definitions_have_one_name_and_others_another(self):
        document = pbrt.Document()
        one, other = document.material("diffuse", {"float x": 1.0}), document.material("diffuse", {"float x": 2.0})
        self.assertNotEqual(one, other)
        self.assertEqual(document.material("diffuse", {"float x": 1.0}), one)
        self.assertEqual(len(document.definitions), 2)


class Meshes(unittest.TestCase):
    def test_corners_are_shared_only_where_all_is_equal(self):
        vertex, uv = np.array([0, 1, 2, 0, 1, 2], np.uint32), np.array([[0, 0], [1, 0], [0, 1], [0, 0], [1, 0.5], [-0.0, 1]], np.float32)
        stands, of_corner = ply.shared([vertex, uv])
        self.assertEqual(len(stands), 4)
        np.testing.assert_array_equal(vertex[stands][of_corner], vertex)
        np.testing.assert_array_equal(uv[stands][of_corner], uv)

    def test_the_renderer_reads_what_is_written(self):
        """A floor of two triangles with colours, in a scene of its own."""
        points = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
        triangles, normals = np.array([[0, 1, 2], [0, 2, 3]]), np.tile(np.float32([0, 0, 1]), (4, 1))
        with tempfile.TemporaryDirectory() as folder:
            write = lambda points, normals: ply.write(folder, points, triangles, normals, points[:, :2], np.full((4, 3), 0.5, np.float32))  # noqa: E731
            name = write(points, normals)
            self.assertEqual(write(points, normals), name)
            for change, same in ((1e-7, True), (-2e-7, True), (1e-3, False)):
                turned = normals.copy()
                turned[1, 0] += change
                self.assertEqual(write(points, turned) == name, same, change)
            moved = points.copy()
            moved[0, 0] += 1e-6
            self.assertNotEqual(write(moved, normals), name)
            document = pbrt.Document()
            document.head = [pbrt.directive("Film", "rgb", **{"integer xresolution": 4, "integer yresolution": 4}), "Scale 1 1 -1",
                             pbrt.directive("Camera", "orthographic", **{"float screenwindow": [-0.5, 0.5, -0.5, 0.5]})]
            color = document.define("Texture", "spectrum", "latent:vertexcolor")
            made = document.material("diffuse", {"texture reflectance": color})
            document.body = [pbrt.directive("LightSource", "infinite", **{"rgb L": [1.0, 1.0, 1.0]}), "Translate 0 0 -1", f'NamedMaterial "{made}"',
                             iter([pbrt.directive("Shape", "plymesh", **{"string filename": name})])]
            document.write(f"{folder}/scene.pbrt")
            report, _ = tools.run([TOOLS / "latent-render", f"{folder}/scene.pbrt", "-o", f"{folder}/a.latent", "--spp", "256", "--json", "--record", "xyz"])
            self.assertEqual(report["samples_rendered"], 4096)
            picture = develop.rgb(develop.develop(TOOLS / "latent-develop", f"{folder}/a.latent", f"{folder}/a.exr"))
        # A matt floor under an even sky of 1 has the radiance of its reflectance, without noise.
        np.testing.assert_allclose(picture, 0.5, atol=2e-3)


class Pictures(unittest.TestCase):
    def test_pictures_of_several_tiles_and_layers_are_read(self):
        with tempfile.TemporaryDirectory() as folder:
            tool("inspect", "gen", "-o", f"{folder}/a.latent", "--records", "4000", "--aspect", "10:9")
            tool("develop", f"{folder}/a.latent", "-o", f"{folder}/a.exr", "--size", "300x270", "--layers", "weight")
            channels = develop.read(f"{folder}/a.exr")
            self.assertEqual(channels["R"].shape, (270, 300))
            self.assertIn("weight", channels)
            tool("develop", f"{folder}/a.latent", "-o", f"{folder}/b.exr", "--size", "300x270", "--crop", "255,200,300,270")
            np.testing.assert_array_equal(develop.read(f"{folder}/b.exr")["G"], channels["G"][200:270, 255:300])

    def test_other_pictures_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            tool("inspect", "gen", "-o", f"{folder}/a.latent", "--records", "1000")
            tool("develop", f"{folder}/a.latent", "-o", f"{folder}/a.exr", "--size", "8x8", "--compression", "zip")
            with self.assertRaisesRegex(ValueError, "not as latent-develop"):
                develop.read(f"{folder}/a.exr")

    def test_white_is_white(self):
        white = {"R": np.float32([[0.95047]]), "G": np.float32([[1.0]]), "B": np.float32([[1.08883]])}
        np.testing.assert_allclose(develop.rgb(white), 1, atol=1e-4)

    def test_drawn_pictures_are_read_as_they_were(self):
        """By the eyes of the renderer: a floor that is lit evenly."""
        values = np.float32([[[0.2, 0.4, 0.6], [1, 0, 0]], [[0, 1, 0], [0.8, 0.8, 0.2]]])
        with tempfile.TemporaryDirectory() as folder:
            drawn = part("export.pictures").Files(f"{folder}/pictures").drawn(values)
            document = pbrt.Document()
            document.head = [pbrt.directive("Film", "rgb", **{"integer xresolution": 2, "integer yresolution": 2}), "Scale 1 1 -1",
                             pbrt.directive("Camera", "orthographic", **{"float screenwindow": [-1.0, 1.0, -1.0, 1.0]})]
            color = document.define("Texture", "spectrum", "imagemap", **{"string filename": drawn, "string filter": "point"})
            made = document.material("diffuse", {"texture reflectance": color})
            document.body = [pbrt.directive("LightSource", "infinite", **{"rgb L": [1.0, 1.0, 1.0]}), "Translate 0 0 -1", f'NamedMaterial "{made}"',
                             'Shape "bilinearmesh" "point3 P" [ -1 -1 0  1 -1 0  -1 1 0  1 1 0 ]']
            document.write(f"{folder}/scene.pbrt")
            tools.run([TOOLS / "latent-render", f"{folder}/scene.pbrt", "-o", f"{folder}/a.latent", "--spp", "1024", "--json", "--record", "xyz"])
            shown = develop.rgb(develop.develop(TOOLS / "latent-develop", f"{folder}/a.latent", f"{folder}/a.exr", ["--filter", "box"]))
        np.testing.assert_allclose(shown[::-1], values, atol=0.01)


class Programs(unittest.TestCase):
    def test_only_progress_is_read_as_progress(self):
        self.assertEqual(tools.share_done("2026-01-01 12:00:00 committed 40 of 160 samples (25.0 %), 1 K samples/s"), 0.25)
        self.assertIsNone(tools.share_done("latent-render: warning: committed to nothing"))

    def test_what_they_list_has_names_and_lines_about_them(self):
        for kind, option, name in (("observer", "--list-observers", "cie1931"), ("lens-filter", "--list-observers", "wratten-25"), ("film", "--list-films", "portra-400")):
            found = dict(tools.listed(TOOLS / "latent-develop", kind, option))
            self.assertGreater(len(found), 10)
            self.assertTrue(found[name])
            self.assertNotIn("source:", found)
        self.assertIn("endura", dict(tools.listed(TOOLS / "latent-convert", "paper", "--list-papers")))

    def test_a_program_that_fails_says_why(self):
        with self.assertRaisesRegex(tools.Failure, "missing.pbrt"):
            tools.run([TOOLS / "latent-render", "/missing.pbrt", "-o", "/tmp/never.latent"])

    def test_a_missing_program_is_one_line(self):
        with self.assertRaisesRegex(tools.Failure, "latent-nothing is neither in /nowhere nor on the PATH"):
            tools.find("latent-nothing", "/nowhere")


class Settings:
    record, seed, light_groups, layers, keep_time, render_options = "SPECTRAL", 0, "NONE", set(), False, ""


class Jobs(unittest.TestCase):
    def begin(self, folder, text, parts, wanted=64, **changed):
        document = pbrt.Document()
        document.body = [text]
        mine = job.Job(folder, "frame")
        return mine, mine.begin(document.write(f"{folder}/scene.pbrt"), {**job.options(Settings, None, False), **changed}, parts, None, wanted)

    def test_what_changed_is_said_and_earlier_samples_are_kept_until_they_are_removed(self):
        with tempfile.TemporaryDirectory() as folder:
            first, word = self.begin(folder, "A", {"lamp Key": "1", "world": "2"})
            self.assertEqual(word, "new job")
            self.assertEqual(self.begin(folder, "A", {"lamp Key": "1", "world": "2"})[1], "same job: it resumes")
            for path in (first.samples, f"{folder}/other.latent", f"{folder}/other-0123456789ab.latent"):  # the last two are not its own
                open(path, "w").close()
            self.assertIn("missing samples", self.begin(folder, "A", {"lamp Key": "1", "world": "2"})[1])
            self.assertEqual(job.old(folder), [])
            second, word = self.begin(folder, "B", {"lamp Key": "3", "world": "2"})
            self.assertIn("new job: lamp Key changed", word)
            self.assertEqual(job.old(folder), [first.samples])
            self.assertEqual(job.Job(folder, "frame").samples, second.samples)
            self.assertIn("back to an earlier job", self.begin(folder, "A", {"lamp Key": "1", "world": "2"})[1])
            self.assertEqual(job.old(folder), [])
            word = self.begin(folder, "A", {"lamp Key": "1", "world": "2"}, seed=["--seed", "3"], records=["--record", "xyz"])[1]
            self.assertIn("new job: records, seed changed", word)

    def test_missing_samples_are_said_to_be_added_only_where_some_are_missing(self):
        with tempfile.TemporaryDirectory() as folder:
            mine, _ = self.begin(folder, "A", {})
            open(mine.samples, "w").close()
            darkroom = job.Job(folder, "frame")  # develops meanwhile
            mine.finish(64)
            darkroom.keep(developed={})
            self.assertEqual(self.begin(folder, "A", {})[1], "same job: all of its samples are there")
            self.begin(folder, "B", {})
            self.begin(folder, "A", {})
            self.assertEqual(self.begin(folder, "A", {}, wanted=32)[1], "same job: all of its samples are there")
            self.assertEqual(self.begin(folder, "A", {}, wanted=65)[1], "same job: missing samples are added")
            pathlib.Path(mine.samples).unlink()
            self.assertEqual(self.begin(folder, "A", {})[1], "same job: it resumes")

    def test_a_picture_is_developed_once_and_again_for_more_samples(self):
        with tempfile.TemporaryDirectory() as folder:
            mine, _ = self.begin(folder, "A", {})
            tool("inspect", "gen", "-o", mine.samples, "--records", "4000")
            first, path = mine.develop(TOOLS / "latent-develop", mine.picture, ["--size", "20x20"])
            again = job.Job(folder, "frame")  # Blender was closed
            for words, layers in ((["--size", "20x20"], ["weight"]), (["--size", "10x10"], [])):
                with self.assertRaisesRegex(tools.Failure, "not there yet"):
                    again.develop(None, f"{folder}/b.exr", words, layers)
            kept, where = again.develop(None, f"{folder}/b.exr", ["--size", "20x20"])
            self.assertEqual((where, path), (mine.picture, mine.picture))
            np.testing.assert_array_equal(kept["R"], first["R"])
            tool("inspect", "gen", "-o", mine.samples, "--records", "8000", "--force")
            with self.assertRaisesRegex(tools.Failure, "not there yet"):
                again.develop(None, f"{folder}/b.exr", ["--size", "20x20"])


class Lights(unittest.TestCase):
    def test_a_mix_is_the_sum_of_the_pictures_of_its_lights(self):
        with tempfile.TemporaryDirectory() as folder:
            document = pbrt.Document()
            document.head = [pbrt.directive("Film", "rgb", **{"integer xresolution": 8, "integer yresolution": 6}), 'Camera "perspective"']
            document.body = ['LightSource "infinite" "string name" "World" "rgb L" [ .2 .3 .4 ]', 'LightSource "point" "string name" "Key" "rgb I" [ 3 2 1 ]',
                             "Translate 0 0 3", 'Material "diffuse"', 'Shape "sphere"']
            document.write(f"{folder}/scene.pbrt")
            tools.run([TOOLS / "latent-render", f"{folder}/scene.pbrt", "-o", f"{folder}/a.latent", "--spp", "16", "--light-groups", "--json"])
            at = lambda *words: develop.develop(TOOLS / "latent-develop", f"{folder}/a.latent", f"{folder}/a.exr", words)  # noqa: E731
            layers = at("--layers", "lights")
            self.assertEqual(set(develop.lights(layers)), {"World", "Key"})
            mix, expected = develop.mixed(layers, {"Key": 2.5, "World": 0.0, "Gone": 3.0}), at("--light", "Key=2.5", "--light", "World=0")
            for name in "RGB":
                self.assertGreater(expected[name].max(), 0)
                np.testing.assert_allclose(mix[name], expected[name], atol=1e-5 * layers[name].max())


class FakeNode:
    """Enough of a node for Graph."""

    def __init__(self, kind, inputs=(), **values):
        self.type, self.mute, self.bl_label, self.name = kind, False, kind.title(), kind
        self.inputs = list(inputs)
        for socket in self.inputs:
            socket.node = self
        for key, value in values.items():
            setattr(self, key, value)


class FakeSocket:
    def __init__(self, name, value, kind="VALUE", source=None):
        self.name = self.identifier = name
        self.default_value, self.type, self.enabled = value, kind, True
        self.is_linked = source is not None
        self.links = [types.SimpleNamespace(from_node=source, from_socket=FakeSocket("Value", 0.0), is_muted=False)] if source else []


class Nodes(unittest.TestCase):
    def setUp(self):
        self.lost = []
        self.graph = nodes.Graph(None, self.lost.append)

    def test_constants_are_folded(self):
        inner = FakeNode("MATH", [FakeSocket("a", 2.0), FakeSocket("b", 3.0)], operation="POWER", use_clamp=False)
        outer = FakeNode("MATH", [FakeSocket("a", 0.0, source=inner), FakeSocket("b", 0.25)], operation="MULTIPLY", use_clamp=True)
        self.assertEqual(self.graph.value(FakeSocket("x", 0.0, source=outer)), values.constant(1.0))

    def test_a_power_that_is_no_number_is_0(self):
        for base, exponent, expected in ((2, 3, 8), (-2, 3, -8), (0, 0, 1), (0, -1, 0), (-2, 0.5, 0), (100, 1000, 0)):
            node = FakeNode("MATH", [FakeSocket("a", float(base)), FakeSocket("b", float(exponent))], operation="POWER", use_clamp=False)
            self.assertEqual(self.graph.value(FakeSocket("x", 0.0, source=node)).number(), expected, (base, exponent))

    def test_a_colour_is_its_luminance_where_a_number_is_wanted(self):
        color = FakeNode("RGB")
        socket = FakeSocket("x", 0.0, source=color)
        socket.links[0].from_socket.default_value = (2.0, 0.0, 0.0, 1.0)
        self.assertEqual(self.graph.value(socket), values.constant(2 * 0.2126))
        socket.type = "RGBA"
        self.assertEqual(self.graph.value(socket).rgb, (2.0, 0.0, 0.0))

    def test_every_blend_of_constants_is_that_of_its_definition(self):
        a, b = values.constant(0.5), values.constant(0.25)
        for blend, expected in {"MIX": 0.375, "MULTIPLY": 0.3125, "ADD": 0.625, "SUBTRACT": 0.375, "SCREEN": 0.5625, "DARKEN": 0.375, "LIGHTEN": 0.5,
                                "DIFFERENCE": 0.375, "DIVIDE": 1.25}.items():
            self.assertAlmostEqual(nodes.BLENDS[blend](a, b, values.constant(0.5)).number(), expected, msg=blend)

    def test_an_unknown_node_is_its_colour_and_listed(self):
        node = FakeNode("TEX_NOISE", [FakeSocket("Scale", 5.0), FakeSocket("Color", (0.1, 0.2, 0.3, 1), "RGBA")])
        self.assertEqual(self.graph.value(FakeSocket("x", 0.0, "RGBA", node)).rgb, (0.1, 0.2, 0.3))
        self.assertEqual(len(self.lost), 1)

    def test_textures_are_defined_with_what_they_consist_of(self):
        document = pbrt.Document()
        picture = values.Texture("imagemap", {"string filename": "a.png"})
        made = values.parameter(document, "color", "spectrum", values.mix(picture, values.WHITE, values.constant(0.5)))
        self.assertEqual(list(made), ["texture color"])
        self.assertEqual(len(document.definitions), 2)

    def test_blackbodies_have_the_colours_of_the_planckian_locus(self):
        """(x, y) at 2856 K is (0.4476, 0.4075), illuminant A; the fit of the observer is good to 0.004."""
        rgb = np.array(nodes.blackbody_rgb(2856))
        xyz = np.linalg.inv(develop.RGB_FROM_XYZ) @ rgb
        np.testing.assert_allclose((xyz / xyz.sum())[:2], (0.4476, 0.4075), atol=0.004)
        self.assertAlmostEqual(xyz[1], 1, places=2)


class Spectra(unittest.TestCase):
    def test_an_abbe_number_comes_back(self):
        numbers = np.array(spectra.cauchy(1.5, 40)).reshape(-1, 2)
        n = {line: np.interp(line, *numbers.T) for line in (spectra.D_NM, spectra.F_NM, spectra.C_NM)}
        self.assertAlmostEqual(n[spectra.D_NM], 1.5, places=4)
        self.assertAlmostEqual((n[spectra.D_NM] - 1) / (n[spectra.F_NM] - n[spectra.C_NM]), 40, delta=0.1)

    def test_tables_skip_headings_and_are_sorted(self):
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
            file.write("nm,reflectance\n500,0.5\n400,0.25\n")
            file.flush()
            self.assertEqual(spectra.table(file.name), [400.0, 0.25, 500.0, 0.5])


def profile(down, around, value, head="TILT=NONE", kind=1):
    """A file of the intensities value(down, around), which its factors double."""
    numbers = [1, -1, 1.25, len(down), len(around), kind, 2, 0, 0, 0, 2, 0.8, 50, *down, *around, *(value(d, a) for a in around for d in down)]
    return "IESNA:LM-63-2002\r\n[MAKE] none\r\n" + head + "\r\n" + "\r\n".join(f"{number:.9g}" for number in numbers)


class Profiles(unittest.TestCase):
    def test_a_lamp_of_lambert_has_its_flux(self):
        rows = ies.read(profile(range(0, 91), [0], lambda d, _: 1000 * np.cos(np.radians(d))))
        areas = np.sin(ies.DOWN)
        mean = (rows.mean(1) * areas).sum() / areas.sum()
        self.assertAlmostEqual(4 * np.pi * mean / (2 * np.pi * 1000), 1, delta=1e-3)
        self.assertEqual(rows[len(ies.DOWN) // 2 + 1 :].max(), 0)  # upwards

    def test_part_of_a_circle_means_its_mirror_images(self):
        down = range(0, 181, 10)
        for last, fold in ((90, lambda a: min(a % 180, 180 - a % 180)), (180, lambda a: min(a, 360 - a))):
            shape = lambda d, a: 100 + d + a * d  # noqa: E731
            part = ies.read(profile(down, range(0, last + 1, 30), shape))
            whole = ies.read(profile(down, range(0, 361, 30), lambda d, a: shape(d, fold(a))))
            np.testing.assert_allclose(part, whole, rtol=1e-5)

    def test_a_tilted_lamp_is_that_without_its_tilt(self):
        plain = profile([0, 90, 180], [0], lambda d, _: 5.0 + d)
        np.testing.assert_array_equal(ies.read(plain.replace("NONE", "INCLUDE\r\n1\r\n2\r\n0 90\r\n1 0.9")), ies.read(plain))

    def test_what_is_no_profile_is_refused(self):
        good = profile([0, 90], [0], lambda d, _: 5.0)
        for text in ("", "TILT=NONE\n1 2 x", profile([0, 90], [0], lambda d, _: 5.0, kind=2), good[:-3], profile([90, 0], [0], lambda d, _: 5.0)):
            with self.assertRaises((ValueError, IndexError)):
                ies.read(text)


class Curves(unittest.TestCase):
    def test_strands_pass_through_their_points_and_straight_ones_stay_straight(self):
        points = np.array([[0, 0, 0], [0, 0, 1], [0, 0, 3], [0, 0, 4]], float)
        control = curves.bezier(points)
        np.testing.assert_array_equal(control[::3], points)
        np.testing.assert_array_equal(control[:, :2], 0)
        self.assertTrue((np.diff(control[:, 2]) > 0).all())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
