#!/bin/sh
. ../sweeps.sh
for name in speed memory line sample cells window eye messages others; do
    sweep $name
done
# Where queues block, some points get stuck.
rm -f flow.csv flow.parquet flow.journal
$pcs_sim sweep flow.ron -o flow.csv --accept-failures > /dev/null 2>&1
rm flow.parquet flow.journal
table figure3 figure3.awk speed.csv memory.csv published.csv line.csv
table table table.awk published.csv memory.csv
table losses losses.awk speed.csv
table machines machines.awk ../capitan/machines.csv speed.csv memory.csv line.csv
plot figure3 figure3 "The teapot, 512 x 512, three lights: speed-up of the iPSC/2" x=nodes y=speed_up by=version
plot losses losses "Regions: what the nodes' time goes to (%)" x=nodes y=share by=what
plot sample sample "32 nodes: seconds over the share of sampled pixels (%)" x=sub_sample y=seconds by=flow
plot cells cells "32 nodes: efficiency over the cells along a side" x=cell_grid y=efficiency
plot flow flow "256 x 256, 32 nodes: efficiency over the slots of a node" x=queue_rays y=efficiency by=flow nodes=32 pixel_order=scan
plot messages messages "32 nodes: efficiency over what a short message takes (µs)" x=short_us y=efficiency
plot machines machines "The teapot, 512 x 512, three lights: seconds for the whole image" x=processors y=seconds by=machine
