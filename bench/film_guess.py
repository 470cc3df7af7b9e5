#!/usr/bin/env python3
"""What guessing spectra from colours costs a film: beside spectral_film_lut, which has the same data of the same films.

    scripts/install peers && .peers/bin/python bench/film_guess.py [TOOLS [patches]]

TOOLS: the folder of latent-convert [build/bin]; needs oiiotool too. The 24 patches of the ColorChecker lie under D55. Their exposures of
the film's layers are added up from the true spectra, and guessed by spectral_film_lut from X, Y, Z; both relative to the grey card. Both are
then printed by the same latent-convert. Prints, for each film, the guess's error in stops and the difference of the prints (CIEDE2000);
with `patches`, for each patch too."""
import pathlib
import sys

import colour
import numpy as np
import spectral_film_lut
from spectral_film_lut.config import SPECTRAL_SHAPE
from spectral_film_lut.film_spectral import FilmSpectral
from spectral_film_lut.xy_lut import apply_2d_lut

sys.dont_write_bytecode = True
from harness import printed_exposures

TOP = pathlib.Path(__file__).resolve().parent.parent
TOOLS = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else TOP / "build/bin")
FILMS = [("Kodak Portra 400", "portra-400", "endura"), ("Kodak Gold 200", "gold-200", "endura"), ("Kodak Ektar 100", "ektar-100", "supra-endura"),
         ("Fuji Pro 400H", "pro-400h", "crystal-archive-super-c"), ("Fuji Velvia 50", "velvia-50", "light-table"),
         ("Kodachrome 64", "kodachrome-64", "light-table")]
NM = SPECTRAL_SHAPE.range()
METHODS = ["SFL upsampling", "Mallett 2019", "Simple Matrix"]


def table(path):
    rows = [line.split(",") for line in path.read_text().splitlines() if line and not line.startswith("#")]
    return np.array([[float(v) for v in row] for row in rows if row[0][0].isdigit()])


def patches():
    data = table(TOP / "color/data/colorchecker_ohta1997_5nm.csv")
    return np.stack([np.interp(NM, data[:, 0], column) for column in data[:, 1:].T])


def main():
    stocks = {stock.name: stock for stock in spectral_film_lut.FILM_STOCKS}
    reflectance = patches()
    light = np.interp(NM, colour.SDS_ILLUMINANTS["D55"].wavelengths, colour.SDS_ILLUMINANTS["D55"].values)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    matching = np.stack([np.interp(NM, observer.wavelengths, observer.values[:, c]) for c in range(3)], axis=1)
    scale = 1 / (light @ matching)[1]
    xyz = scale * (reflectance * light) @ matching
    grey_xyz = 0.18 * scale * light @ matching
    print(f"{'film':<16}{'method':<18}{'layers, stops: mean, largest':<32}{'print, dE2000: mean, largest':<32}patch")
    for name, film, paper in FILMS:
        stock = FilmSpectral(stocks[name])
        sensitivity = np.asarray(stock.sensitivity, dtype=float)
        true = (reflectance * light) @ sensitivity / (0.18 * light @ sensitivity)
        for method in METHODS:
            lut_in = np.concatenate([xyz, grey_xyz[None]]).astype(np.float32)
            lut = stock.get_input_lut(5503, upsampling_method=method)
            guessed = np.asarray(apply_2d_lut(lut_in, lut), dtype=float)
            guessed = np.maximum(guessed[:-1] / guessed[-1], 1e-4)
            stops = np.abs(np.log2(guessed / true))
            a, b = (np.array(printed_exposures(TOOLS, e * 10 / stock.iso, paper, film, stock.iso)) for e in (true, guessed))
            lab = [colour.XYZ_to_Lab(v, [1 / 3, 1 / 3]) for v in (a, b)]
            differences = colour.difference.delta_E_CIE2000(*lab)
            print(f"{film:<16}{method:<18}{f'{stops.mean():.3f}, {stops.max():.3f}':<32}"
                  f"{f'{differences.mean():.2f}, {differences.max():.2f}':<32}{differences.argmax() + 1}")
            if "patches" in sys.argv[2:]:
                signed = np.log2(guessed / true)
                for i, (layers, difference) in enumerate(zip(signed, differences)):
                    print(f"    {i + 1:>2}  stops: {layers[0]:+.2f} {layers[1]:+.2f} {layers[2]:+.2f}  dE2000 {difference:.2f}")


main()
