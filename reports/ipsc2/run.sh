#!/bin/sh
. ../sweeps.sh
sweep speed
sweep memory
sweep tiles
sweep sample
sweep cells
sweep cuts
sweep flow
sweep slots
sweep_where_some_fail block
sweep window
sweep eye
sweep messages
sweep line
sweep bundles
table figure3 figure3.awk speed.csv memory.csv published.csv
table table table.awk published.csv memory.csv
table losses losses.awk speed.csv
table stuck stuck.awk block.csv
table machines machines.awk ../capitan/machines.csv speed.csv memory.csv line.csv
plot figure3 figure3 "The teapot, 512 x 512, three lights: speed-up of the iPSC/2" x=nodes y=speed-up by=version log=none
plot losses losses "Regions: what the nodes' time goes to (%)" x=nodes y=share by=what
plot tiles tiles "A shared memory: pixels by lines in turn, or by tiles on demand" x=nodes y=efficiency by=distribution
plot sample sample "32 nodes, 256 x 256: seconds over the share of pixels sampled" x=sub_sample y=seconds by=flow log=x
plot cells cells "32 nodes, 256 x 256: how fine the cells are, and whose grid a node has" x=cell_grid y=efficiency by=grids
plot messages messages "256 x 256: efficiency over what a short message takes" x=short_us y=efficiency by=nodes flow=classes
plot machines machines "The teapot, 512 x 512, three lights: seconds for the whole image" x=processors y=seconds by=machine
