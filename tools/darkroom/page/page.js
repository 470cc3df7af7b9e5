// The darkroom's page. Each part of it finds its controls in page.html.
// @ts-check
import "./exposure.js";
import "./film.js";
import "./lens.js";
import "./light_mix.js";
import "./crop.js";
import "./rulers.js";
import "./draw.js";
import "./probe.js";
import "./noise_map.js";
import "./compare.js";
import "./by_eye.js";
import "./saved.js";
import "./prints.js";
import "./keys.js";
import { show_samples } from "./picture.js";
import { changed } from "./recipe.js";

show_samples();
changed();
