"""The tools on files of web servers: what comes of them is what comes of the same files on disk, and little more is transferred."""
import json
import os
import shutil
import socket
import subprocess
import time
import unittest

from server import Server
from support import TOOLS, FarmTest, run

PYTHON = os.environ.get("LATENT_PYTHON") or "/usr/bin/python3"  # that the Python module is for
NGINX = """daemon off; worker_processes 1; pid {folder}/nginx.pid; error_log {folder}/nginx.log;
events {{ worker_connections 256; }}
http {{
    access_log off; client_body_temp_path {folder}/a; proxy_temp_path {folder}/b; fastcgi_temp_path {folder}/c;
    uwsgi_temp_path {folder}/d; scgi_temp_path {folder}/e;
    server {{ listen 127.0.0.1:{port}; root {folder}; location /slow/ {{ alias {folder}/; limit_rate 256k; }} }}
}}
"""


class Remote(FarmTest):
    def setUp(self):
        super().setUp()
        self.server = Server(self.folder)
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)

    def generate(self, name, *options):
        self.succeed("latent-inspect", "gen", "-o", self.folder / name, *(() if "--precision" in options else ("--precision", 9)), *options)

    def same_from_afar(self, verb, file, *options, way="plain", suffix=".exr"):
        """Both files that a tool makes: of a file on disk, and of the same on the server. What it printed of the latter."""
        made = []
        for place in (self.folder / file, self.server.url(file, way)):
            made.append(self.folder / f"made-{len(made)}{suffix}")
            done = self.succeed(verb, place, "-o", made[-1], "--force", "--quiet", *options)
        self.assertEqual(made[0].read_bytes(), made[1].read_bytes())
        return done.stdout

    def test_a_crop_transfers_little_more_than_its_share_over_many_connections(self):
        self.generate("parts.latent", "--records", "16Mi", "--aspect", "3:2")
        self.generate("long.latent", "--records", "16Mi", "--aspect", "3:2", "--run-samples", "4Mi")
        self.succeed("latent-merge", self.folder / "parts.latent", "-o", self.folder / "all.latent", "--compact")
        self.server.delay = 0.3  # long beside what a busy machine takes to ask
        for name, runs, most in (("parts.latent", 8, 1 / 31), ("long.latent", 4, 1 / 36), ("all.latent", 1, 1 / 45)):
            self.server.reset()
            done = self.same_from_afar("latent-develop", name, "--size", "3000x2000", "--crop", "1301,1111,1676,1361", "--json")  # 1/64
            self.assertLess(self.server.sent, (self.folder / name).stat().st_size * most)
            # The first bytes of the file, its end, the zeros behind each index, and in each run one gap of up to 16 KiB, such as a
            # small page between two that are needed: no byte beside these and those of pages and indexes.
            self.assertLess(self.server.sent - json.loads(done)["bytes_read"], (16 << 10) + (20 << 10) * (runs + 1))
            self.assertGreaterEqual(self.server.most_at_once, 16)

    def test_a_preview_transfers_the_runs_that_it_is_made_of(self):
        self.generate("a.latent", "--records", "1Mi", "--run-samples", "32Ki")
        self.server.reset()
        self.same_from_afar("latent-develop", "a.latent", "--size", "64", "--fraction", "0.1")
        self.assertLess(self.server.sent, (self.folder / "a.latent").stat().st_size / 5)

    def test_what_is_read_in_order_is_read_ahead_of_in_bounded_memory(self):
        self.generate("parts.latent", "--records", "6Mi", "--run-samples", "512Ki", "--precision", 23)
        self.succeed("latent-merge", self.folder / "parts.latent", "-o", self.folder / "all.latent", "--compact")
        self.assertGreater((self.folder / "all.latent").stat().st_size, 50 << 20)
        self.server.delay = 0.1
        self.server.reset()
        verify = subprocess.Popen([TOOLS / "latent-inspect", "verify", self.server.url("all.latent")], stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(verify.pid, 0)
        verify.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(verify.returncode, 0)
        self.assertGreaterEqual(self.server.most_at_once, 8)
        if "asan" not in str(TOOLS):
            self.assertLess(usage.ru_maxrss << 10, 100 << 20)

    def test_indexes_of_many_runs_are_on_their_way_together(self):
        self.generate("parts.latent", "--records", "1Mi", "--run-samples", "16Ki")
        self.server.delay = 0.3
        self.same_from_afar("latent-develop", "parts.latent", "--size", "512", "--crop", "0,0,16,16")
        self.assertGreaterEqual(self.server.most_at_once, 16)
        self.assertGreater(self.server.requests, 32)

    def test_neighbouring_runs_come_with_one_request(self):
        self.generate("a.latent", "--records", "1Mi", "--run-samples", "1024")
        size = (self.folder / "a.latent").stat().st_size
        self.server.reset()
        self.same_from_afar("latent-develop", "a.latent", "--size", "512", "--crop", "0,0,100,100")
        # Indexes and pages are read once each. A request brings up to 128 KiB, or less where a reader would have waited.
        self.assertLess(self.server.requests, 2 * 2 * size / (128 << 10))

    def test_a_server_that_lies_costs_no_memory(self):
        self.generate("a.latent", "--records", "10K")
        peaks = []
        for way in ("refused", "overflowing-size", "impossible-size", "endless-404", "endless-bytes", "endless-header", "more", "bottomless"):
            process = subprocess.Popen([TOOLS / "latent-inspect", "info", self.server.url("a.latent", way)], stderr=subprocess.PIPE, text=True)
            said = process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            process.stderr.close()
            self.assertEqual((process.returncode, said.count("\n")), (1, 1), said)
            peaks.append(usage.ru_maxrss >> 10)
        self.assertLess(max(peaks), peaks[0] + 16, peaks)

    def test_tools_make_the_same_of_a_file_on_a_rough_server(self):
        self.generate("a.latent", "--records", "20K", "--run-samples", "16Ki", "--light", "0.1")
        self.same_from_afar("latent-develop", "a.latent", "--size", "64", way="rough")
        self.same_from_afar("latent-merge", "a.latent", way="rough", suffix=".latent")
        self.same_from_afar("latent-merge", "a.latent", "--compact", way="rough", suffix=".latent")
        command = ["latent-inspect", "recover"]
        for place, name in ((self.folder / "a.latent", "r0.latent"), (self.server.url("a.latent", "rough"), "r1.latent")):
            self.succeed(*command, place, "-o", self.folder / name)
        self.assertEqual((self.folder / "r0.latent").read_bytes(), (self.folder / "r1.latent").read_bytes())
        self.succeed("latent-inspect", "verify", "--deep", self.server.url("a.latent", "rough"))
        here, there = (self.succeed("latent-inspect", "cat", place).stdout
                       for place in (self.folder / "a.latent", self.server.url("a.latent", "rough")))
        self.assertEqual(here, there)

    def test_parts_on_several_servers_and_on_disk_are_merged(self):
        self.generate("all.latent", "--records", "96Ki", "--run-samples", "32Ki")
        for i in range(3):
            self.generate(f"{i}.latent", "--records", "32Ki", "--run-samples", "32Ki", "--first", 32768 * i)
        other = Server(self.folder)
        self.addCleanup(other.server_close)
        self.addCleanup(other.shutdown)
        self.succeed("latent-merge", self.server.url("2.latent"), self.folder / "0.latent", other.url("1.latent?X-Signature=secret"),
                     "-o", self.folder / "merged.latent")
        self.succeed("latent-merge", self.folder / "all.latent", "-o", self.folder / "one.latent")
        runs = [json.loads(self.succeed("latent-inspect", "info", "--json", self.folder / name).stdout)["runs"]
                for name in ("merged.latent", "one.latent")]
        self.assertEqual(runs[0], runs[1])

    def test_damage_on_the_server_is_left_out_and_listed(self):
        self.generate("a.latent", "--records", "96Ki", "--run-samples", "32Ki")
        data = bytearray((self.folder / "a.latent").read_bytes())
        data[len(data) // 2] ^= 1
        (self.folder / "a.latent").write_bytes(data)
        self.succeed("latent-inspect", "verify", self.server.url("a.latent"), status=4)
        self.succeed("latent-merge", self.server.url("a.latent"), "-o", self.folder / "m.latent", status=3)

    def test_an_unfinished_part_gives_what_is_committed(self):
        self.generate("a.latent", "--records", "96Ki", "--run-samples", "32Ki")
        size = (self.folder / "a.latent").stat().st_size
        part = "b.latent.part.0123456789abcdef"
        shutil.copy(self.folder / "a.latent", self.folder / part)
        os.truncate(self.folder / part, size * 2 // 3)
        done = self.succeed("latent-develop", self.server.url(part), "--size", 32, "-o", self.folder / "b.exr", "--json")
        self.assertGreaterEqual(json.loads(done.stdout)["camera_records"], 32768)

    def test_what_cannot_be_read_fails_with_one_line_and_no_secret_and_no_output(self):
        self.generate("a.latent", "--records", "10K")
        (self.folder / "text").write_text("not samples")
        for way, name, what in (("plain", "none.latent", "there is no such file on the server"), ("refused", "a.latent", "status 403"),
                                ("whole", "a.latent", "must support range requests"), ("broken", "a.latent", "status 500"),
                                ("other", "a.latent", "another range"), ("plain", "text", "not a Latent file")):
            out = self.folder / "out.exr"
            self.fail_with(what, "latent-develop", self.server.url(name, way), "-o", out)
            self.assertFalse(out.exists())
        with socket.socket() as nobody:
            nobody.bind(("127.0.0.1", 0))
            self.fail_with("127.0.0.1", "latent-inspect", "info", f"http://127.0.0.1:{nobody.getsockname()[1]}/a.latent")

    def test_what_a_url_holds_in_secret_is_printed_and_written_nowhere(self):
        self.generate("a.latent", "--records", "96Ki", "--run-samples", "32Ki")
        self.generate("b.latent", "--records", "32Ki", "--seed", 1)
        data = bytearray((self.folder / "a.latent").read_bytes())
        data[len(data) // 2] ^= 1
        (self.folder / "damaged.latent").write_bytes(data)
        (self.folder / "cut.latent").write_bytes(data[:len(data) // 3])
        (self.folder / "text").write_text("not samples")
        damaged, cut, text, a, b = (self.server.url(f"{name}?X-Signature=secret").replace("//", "//me:secret@")
                                    for name in ("damaged.latent", "cut.latent", "text", "a.latent", "b.latent"))
        refused = self.server.url("a.latent?X-Signature=secret", "refused")
        out, here = self.folder / "out.latent", self.folder / "a.latent"
        for command in (["latent-inspect", "info", a], ["latent-inspect", "info", "--json", a, cut, text, refused],
                        ["latent-inspect", "verify", a, damaged, cut, text], ["latent-inspect", "verify", "--json", "--deep", damaged, cut],
                        ["latent-inspect", "verify", "--strict", damaged], ["latent-inspect", "cat", damaged, "--format", "json"],
                        ["latent-inspect", "recover", damaged, "-o", out, "--json"], ["latent-inspect", "recover", text, "-o", out],
                        ["latent-merge", damaged, "-o", out], ["latent-merge", a, a, "-o", out], ["latent-merge", a, b, "-o", out],
                        ["latent-merge", a, cut, text, refused, "-o", out, "--keep-going", "--json"],
                        ["latent-merge", damaged, "-o", out, "--compact", "--json"], ["latent-merge", refused, "-o", out],
                        ["latent-merge", here, a, "-o", out, "--skip-duplicates"],
                        ["latent-develop", damaged, "--size", 32, "-o", self.folder / "out.exr", "--json"],
                        ["latent-develop", a, b, "-o", self.folder / "none.exr"], ["latent-develop", a, "--light", "x", "-o", self.folder / "none.exr"],
                        ["latent-render", TOOLS.parent.parent / "scenes/cornell.pbrt", "--more-than", a, "-o", out]):
            done = run(*command, *([] if "-o" not in command or "latent-inspect" in command else ["--force"]))
            self.assertNotIn("secret", done.stdout + done.stderr, command)
            for made in (out, self.folder / "out.exr"):
                if made.exists():
                    self.assertNotIn(b"secret", made.read_bytes(), command)
                    made.unlink()
        self.assertIn("damaged.latent?...: ", run("latent-inspect", "verify", damaged).stdout)
        self.assertEqual(json.loads(run("latent-inspect", "info", "--json", a).stdout)["file"],
                         self.server.url("a.latent?..."))

    def test_the_library_reads_urls(self):
        self.generate("a.latent", "--records", "96Ki", "--run-samples", "32Ki")
        here, there = (self.succeed(TOOLS / "example_read", place).stdout for place in (self.folder / "a.latent", self.server.url("a.latent")))
        self.assertEqual(here, there)
        self.fail_with("a.latent?...: the server refuses access", TOOLS / "example_read", self.server.url("a.latent?X-Signature=secret", "refused"))

    @unittest.skipUnless(list((TOOLS.parent / "python/latent").glob("_latent*.so")), "the Python module is not built")
    def test_the_python_module_reads_urls(self):
        self.generate("a.latent", "--records", "96Ki", "--run-samples", "32Ki")
        self.server.reset()
        script = "import latent, sys; r = latent.open(sys.argv[1]).read(region=(0.1, 0.1, 0.15, 0.2)); print(len(r['x']), r['x'].sum(), r['u'].max())"
        here, there = (subprocess.run([PYTHON, "-B", "-c", script, place], env={**os.environ, "PYTHONPATH": TOOLS.parent / "python"},
                                      check=True, capture_output=True, text=True).stdout
                       for place in (self.folder / "a.latent", self.server.url("a.latent")))
        self.assertEqual(here, there)
        self.assertLess(self.server.sent, (self.folder / "a.latent").stat().st_size / 2)

    @unittest.skipUnless(shutil.which("nginx"), "nginx is not installed")
    def test_nginx_serves_what_is_on_its_disk(self):
        self.generate("a.latent", "--records", "200K", "--run-samples", "64Ki")
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.folder.chmod(0o755)  # nginx's workers have a user of their own
        (self.folder / "nginx.conf").write_text(NGINX.format(folder=self.folder, port=port))
        nginx = subprocess.Popen(["nginx", "-c", self.folder / "nginx.conf", "-e", self.folder / "nginx.log"])
        self.addCleanup(nginx.wait)
        self.addCleanup(nginx.terminate)
        url = f"http://127.0.0.1:{port}/a.latent"
        for _ in range(100):
            if run("latent-inspect", "verify", "--quick", url).returncode == 0:
                break
            time.sleep(0.1)
        for place in (url, url.replace("a.latent", "slow/a.latent")):
            self.succeed("latent-merge", place, "-o", self.folder / "b.latent", "--force")
            self.succeed("latent-merge", self.folder / "a.latent", "-o", self.folder / "c.latent", "--force")
            self.assertEqual((self.folder / "b.latent").read_bytes(), (self.folder / "c.latent").read_bytes())
        self.fail_with("no such file on the server", "latent-inspect", "info", url + "x")


if __name__ == "__main__":
    unittest.main()
