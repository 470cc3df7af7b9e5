// tools/convert/help.h: the text of `--help` below the options: formats, profiles, whites, examples, exit status.
#pragma once

namespace latent::convert::help {

inline constexpr const char* kConvert = R"(
Formats, by the extension of the output:
  .png .tif .jpg   the print as code values, with a colour profile
  .exr             the print as linear light
  .dzi             a Deep Zoom pyramid of tiles, with NAME.html to view it

Profiles:
  srgb, display-p3, rec2020, adobe-rgb
  rx,ry,gx,gy,bx,by,wx,wy   chromaticities of the primaries and the white
  9 numbers                 matrix from XYZ to RGB, separated by commas
  FILE.icc                  profile of primaries and curves, or of tables
                            (printers: RGB, or CMYK for .tif and .jpg); it is
                            embedded unchanged

Film (pictures that latent-develop --film wrote; --list-papers shows all):
  endura, 2383 ...          paper or print film for negatives
  light-table, projection   slides; radiance, ilfochrome: paper for slides
  polymax                   black-and-white paper, with --contrast-filter
  scan                      a negative, inverted
  --look NAME               paper, format, grain and halation by one name

Glare (of the light, before exposure and tone; --format is the frame's size):
  f:16                      a round aperture; f:22 spreads light farther
  blades:6,f:8              stars of 6 rays; of 10 with 5 blades
  blades:6:15:0.2,f:8       turned by 15 degrees, with curved blades
  FILE.exr,f:8              a picture of the aperture, white where it is open
  eye, eye,age:70,field:60  an eye; field: degrees of the longer side

Dodge and burn (EV in stops; X, Y, RADIUS in parts of the picture's width, its
height, and its longer side; X and Y from the upper left corner):
  brush:0.5,0.1,0.3,0.7     half a stop brighter around a place; further X,Y
                            pairs make a line, along which the brush goes
  gradient:-1,0.5,0,0.5,0.4 one stop darker at the upper edge, and less down to
                            0.4 of the height

Tone curves (all print luminance 1/X at half of display white):
  film                      1 - 2^-t, where t is sensitivity times luminance
  linear, reinhard, filmic  for comparison
  density                   a slide; density:GAMMA,TOE,SHOULDER for another one
  none                      linear RGB for other programs, not limited to 0..1

Whites:
  D65, D50, A, E, F1 to F12 standard illuminants
  5200K                     daylight, or a blackbody below 4000K
  x,y                       chromaticity
  X,Y,WIDTH,HEIGHT          mean of these pixels, for example of a grey card

Examples:
  latent-convert picture.exr -o picture.png
      print; the sensitivity is chosen from the picture, and reported
  latent-convert picture.exr -o bright.png --stops 1
      one stop brighter than that
  latent-convert picture.exr -o fixed.png --sensitivity 1.6
      the same exposure for every picture, such as those of an animation
  latent-convert picture.exr -o camera.png --exposure iso:100,time:1/125,f:8
      as a camera that is set so shows a scene with lights of true strength
  latent-convert picture.exr -o p3.tif --bits 16 --profile display-p3
      print 16 bits for a wide-gamut display
  latent-convert picture.exr -o lamplight.png --white A
      print a scene lit by incandescent lamps without the orange cast
  latent-convert spectrum.exr -o canon.png --observer canon_eos_5d
      print a spectral picture as a camera sees it
  latent-convert exposures.exr -o print.png --paper endura
      print a colour negative on paper
  latent-convert picture.exr -o wall.tif --tiles --pyramid
      write a tiled pyramid, as BigTIFF if needed
  latent-convert picture.exr -o web.dzi -o preview.jpg --memory 256M
      write two outputs in one pass
  latent-convert picture.exr -o test.png --stops -1,0,1
      write test-1.png, test+0.png and test+1.png in one pass
  latent-convert picture.exr -o sky.png --dodge gradient:-1,0.5,0,0.5,0.4
      burn the sky in by one stop
  latent-convert picture.exr -o corner.png --crop 0,0,512,512
      print a part of the picture

Exit status: 0 done; 1 failed, no output; 2 wrong usage; 3 done, but some pixels
were not finite, or the report could not be written.)";

}  // namespace latent::convert::help
