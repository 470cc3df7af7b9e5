"""The folder of a plan, and what lies in it."""
import contextlib
import dataclasses
import json
import os
import pathlib

from latent_farm import files, names, schema
from latent_farm.errors import Failure
from latent_farm.plan import Plan


class Folder:
    def __init__(self, path):
        self.path = pathlib.Path(os.path.abspath(path))
        self.plan_file = self.path / "plan.json"
        self.parts = self.path / "parts"
        self.logs = self.path / "logs"
        self.merged = self.path / "samples.latent"
        self.picture = self.path / "picture.exr"
        self.print = self.path / "picture.png"
        self.film = self.path / "film.mp4"
        self.strips = self.path / "strips"
        self.jobs = self.path / "jobs.json"
        self.noise = self.path / "noise.json"

    def has_plan(self):
        return self.plan_file.exists()

    def read_plan(self):
        try:
            data = files.read(self.plan_file)
        except FileNotFoundError:
            raise Failure(f"{self.path}: holds no plan; make one with latent-farm plan") from None
        try:
            plan = schema.checked(Plan, files.parse_json(data))
            plan.check()
        except Failure as error:
            raise Failure(f"{self.plan_file}: damaged, or made by another version of latent-farm: {error}") from None
        return plan

    def write_plan(self, plan):
        files.write(self.plan_file, json.dumps(dataclasses.asdict(plan), indent=2) + "\n")

    def read_jobs(self):
        """The numbers of the jobs that were submitted last."""
        try:
            numbers = files.parse_json(files.read(self.jobs))
            if not schema.NUMBERS.holds(numbers):
                raise Failure(f"must be {schema.NUMBERS.text}")
        except FileNotFoundError:
            return []
        except Failure as error:
            raise Failure(f"{self.jobs}: {error}; if none of its jobs is queued, remove it") from None
        return numbers

    def write_jobs(self, numbers):
        files.write(self.jobs, json.dumps(numbers) + "\n")

    def make(self, parts=True):
        names.check_name(str(self.path))
        try:
            for folder in [self.parts, self.logs] if parts else [self.logs]:
                folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise Failure(f"{error.filename}: cannot create the folder: {error.strerror}") from None

    @contextlib.contextmanager
    def made(self):
        """The folder as a plan needs it; if that comes to nothing, it is gone again, unless it was there."""
        was_there = self.path.exists()
        self.make()
        try:
            yield
        except BaseException:
            for folder in [self.parts, self.logs] if was_there else [self.parts, self.logs, self.path]:
                with contextlib.suppress(OSError):  # not empty
                    folder.rmdir()
            raise
