"""What Latent cannot say of a scene, for the panel and the report."""
import operator


class Unknown(Exception):
    """A node that Latent cannot say."""


def find(block, *paths, otherwise):
    """The first of some settings, such as "cycles.max_bounces", that this version of Blender has."""
    for path in paths:
        try:
            return operator.attrgetter(path)(block)
        except AttributeError:
            pass
    return otherwise


def seen_by(path, *rays):
    return tuple((path + ray, True, f"stays visible to {ray.replace('_', ' ')} rays") for ray in rays)


# Settings: where they are, the only value that Latent has, and what is said of any other one.
LINKING = tuple((f"light_linking.{which}_collection", None, "light linking is left out") for which in ("receiver", "blocker"))
SETTINGS = {
    "scene": (("render.film_transparent", False, "its transparent background is opaque"),
              ("render.use_multiview", False, "without stereoscopy, all views are that of the camera"),
              ("cycles.film_exposure", 1, "the exposure of its film is 1; the darkroom has another one")),
    "world": seen_by("cycles_visibility.", "camera", "diffuse", "glossy", "transmission", "scatter"),
    "object": (*seen_by("visible_", "camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"),
               ("is_shadow_catcher", False, "a shadow catcher is an ordinary surface"), *LINKING),
    "lamp": (*seen_by("visible_", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"), ("data.use_shadow", True, "it casts shadows"),
             ("data.cycles.cast_shadow", True, "it casts shadows"), *LINKING),
}


class Report:
    def __init__(self):
        self.lines = {}

    def lost(self, owner, what):
        """`owner`: such as "material Wood". Each line appears once."""
        self.lines.setdefault(f"{owner}: {what}", None)

    def of(self, owner):
        """A function that takes what is lost of one owner."""
        return lambda what: self.lost(owner, what)

    def settings(self, kind, block):
        """Lists those of a data block that Latent lacks."""
        for path, usual, what in SETTINGS[kind]:
            if find(block, path, otherwise=usual) != usual:
                self.lost(f"{kind} {block.name}", what)
