#!/bin/sh
. ../sweeps.sh
sweep one-cell
sweep_where_some_fail cells
sweep_where_some_fail measured
sweep orders
sweep_where_some_fail depth
sweep pipelines
sweep sequential
sweep stop
sweep_where_some_fail links
sweep_where_some_fail groups
sweep_where_some_fail two-queues
sweep_where_some_fail warp
sweep image-one-cell
sweep_where_some_fail image-cells
sweep image-pipelines
sweep image-stop
table broadcast broadcast.awk one-cell.csv cells.csv measured.csv
table broadcast-summary summary.awk keys=order,cells,partition of=speed_up,efficiency,over_busiest,balance,floor broadcast.csv
table orders-speed broadcast.awk one-cell.csv orders.csv
table orders-summary summary.awk keys=order of=speed_up,us_per_ray,over_busiest orders-speed.csv
table deeper depth.awk depth.csv
table deeper-summary summary.awk keys=order,cells,fifo_words of=over_busiest deeper.csv
table grids pipelines.awk sequential.csv pipelines.csv
table grids-summary summary.awk keys=order of=over_busiest,against_one_cell,against_one_cell_at_50,over_busiest_at_50 grids.csv
table slabs slabs.awk sequential.csv
table steps steps.awk sequential.csv pipelines.csv
table slabs-summary summary.awk keys=all of=gain,gain_at_50,words_2_over_1,at_grid_1,at_grid_2 slabs.csv
table stop-words stop.awk sequential.csv pipelines.csv stop.csv
table stop-best best-w.awk stop-words.csv
table stop-summary summary.awk keys=order,grid_coefficient,w of=faster_than_without,faster_than_one_cell stop-words.csv
table slower links.awk links.csv
table slower-summary summary.awk keys=order,cells,link_mb_s of=times_as_long slower.csv
table readings readings.awk cells.csv two-queues.csv warp.csv
table readings-summary summary.awk keys=order,cells,reading of=times_as_long readings.csv
table together groups.awk groups.csv
table together-summary summary.awk keys=order,cells,program of=against_broadcast,words_against_broadcast together.csv
table winners winners.awk together.csv
table images images.awk image-one-cell.csv image-cells.csv image-pipelines.csv
table images-summary summary.awk keys=order,array,partition,grid_coefficient of=speed_up,over_busiest images.csv
table images-stop stop.awk image-one-cell.csv image-pipelines.csv image-stop.csv
table images-stop-summary summary.awk keys=order,grid_coefficient of=faster_than_without,faster_than_one_cell images-stop.csv
plot deeper depth "Broadcast, 16 cells of equal work: time over the work of the busiest cell" x=fifo_words y=over_busiest by=scene facet=order \
    cells=16 log=x
