#!/bin/sh
. ../sweeps.sh
sweep table
sweep seeds
sweep workers
sweep items
sweep polygons
table times times.awk published.csv table.csv
table curves curves.awk published.csv table.csv
table losses losses.awk table.csv
table scenes scenes.awk published.csv seeds.csv
table best best.awk workers.csv
table machines machines.awk ../teapot/published.csv ../teapot/times.csv polygons.csv
plot curves times "100 x 100 pixels, 16 rectangles: seconds for the image" x=workers y=seconds by=times
plot losses losses "100 x 100 pixels: where the workers' time goes" x=workers y=share by=what
plot workers workers "100 x 100 pixels: speed-up with more processors than CAPITAN had" \
    x=tasks y=speed_up by=scene_by size=100x100
plot machines machines "The teapot, 512 x 512, three lights: seconds for the whole image" x=processors y=seconds by=machine
