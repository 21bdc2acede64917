#!/bin/sh
. ../sweeps.sh
sweep speed
sweep memory
table figure3 figure3.awk speed.csv memory.csv published.csv
table table table.awk published.csv memory.csv
table losses losses.awk speed.csv
table machines machines.awk ../capitan/machines.csv speed.csv memory.csv
plot figure3 figure3 "The teapot, 512 x 512, three lights: speed-up of the iPSC/2" x=nodes y=speed_up by=version
plot losses losses "Regions: what the nodes' time goes to (%)" x=nodes y=share by=what
plot machines machines "The teapot, 512 x 512, three lights: seconds for the whole image" x=processors y=seconds by=machine
