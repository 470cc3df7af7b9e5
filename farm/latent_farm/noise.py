"""Rendering until a picture is clean: how noisy it is, and how many samples it takes. docs/farm.md, "Until it is clean"."""
import dataclasses
import json
import math
import re
import typing

from latent_farm import files, schema, tools
from latent_farm.errors import Failure

# As in latent-render --until-noise.
FIRST_SPP = 16
MOST_GROWTH = 4  # of a plan by one round: few samples say little about many
MARGIN = 1.02  # on what is expected to be enough, so that chance does not cost another round

MOST = 1e12  # of a relative standard error that is taken seriously


class Target(typing.NamedTuple):
    """Half of the pixels of a picture have a relative standard error of `relative` or less."""

    relative: float
    width: int  # of the picture; 0: that of --resolution


def target_of(text):
    """Of 2% or 2%@1920; None if it is neither."""
    found = re.fullmatch(r"(\d{1,4}(?:\.\d{1,9})?)%(?:@([1-9]\d{0,6}))?", text, re.ASCII)
    if not found or not 1e-4 <= float(found[1]) <= 1000 or int(found[2] or 0) > 1 << 23:
        return None
    return Target(float(found[1]) / 100, int(found[2] or 0))


TARGET = schema.Rule("empty, or a noise such as 2%@1920", lambda value: value == "" or type(value) is str and target_of(value) is not None)


@dataclasses.dataclass
class Measured:
    """The noise of the first `samples` samples."""

    samples: int = schema.member(schema.whole(1, 1 << 62))
    width: int = schema.member(schema.whole(0, 1 << 23))
    median: float = schema.member(schema.real(0, MOST))  # relative standard error
    exponent: float = schema.member(schema.real(-100, 100))  # the error falls with the samples to minus this power

    def needed(self, target):
        """How many samples meet it."""
        return self.samples * (self.median / target.relative) ** (1 / max(self.exponent, 0.5))

    def expected(self, samples):
        return self.median * (self.samples / samples) ** max(self.exponent, 0.5)


def measure(folder, plan):
    """Looks at all samples of a plan, and keeps the result in its folder."""
    paths = [folder.parts] * any(folder.parts.glob("*.latent")) + [folder.merged] * folder.merged.exists()
    answer = tools.noise([*paths, "--job", plan.job, "--samples", f"0:{plan.samples}", "--skip-duplicates"], plan.target.width)
    level = answer["levels"][0]
    if level["relative"]["median"] is None:
        raise Failure("--until-noise: no light reaches the picture: check where the camera looks and where the lights are")
    found = Measured(level["samples"], plan.target.width, level["relative"]["median"], answer["exponent"])
    files.write(folder.noise, json.dumps(dataclasses.asdict(found)) + "\n")
    return found


def last(folder, plan):
    """What was measured last for the plan's target; None if nothing was."""
    if not plan.target:
        return None
    try:
        found = schema.checked(Measured, files.parse_json(files.read(folder.noise)))
    except FileNotFoundError:
        return None
    except Failure as error:
        raise Failure(f"{folder.noise}: {error}; remove it") from None
    return found if found.width == plan.target.width and found.samples <= plan.samples else None


def is_over(folder, plan):
    """Whether a plan needs no more samples: it has no target, meets it, or may not grow."""
    found = last(folder, plan)
    return not plan.target or bool(found) and found.samples == plan.samples and (found.median <= plan.target.relative or not may_grow(plan))


def may_grow(plan):
    return not plan.max_spp or plan.spp < plan.max_spp


def next_spp(plan, found):
    """The samples per pixel of the next round."""
    growth = min(max(MARGIN * found.needed(plan.target) / plan.samples, MARGIN), MOST_GROWTH)
    return min(math.ceil(100 * growth * plan.spp) / 100, plan.max_spp or math.inf)
