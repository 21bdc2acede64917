//! Work that is stopped from another thread: it ends with that error at its next batch, and leaves no file.

use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

use crate::support::command::Folder;
use crate::support::{machine, ops, program, scene, workload};
use pcs_sim::cancel::{Cancel, Cancelled};
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::policy::HostRules;
use pcs_sim::host::sampling::Sampling;
use pcs_sim::host::shading::Limits;
use pcs_sim::run::{self, Outputs, Picture, RecordingMemory, RunError, Seen, Timed, Watching, Workers};
use pcs_sim::sweep::Sweep;

/// A thread that stops the work and abandons its files when it is asked to, and says when it has.
struct Stopper {
    ask: mpsc::Sender<()>,
    done: mpsc::Receiver<()>,
}

impl Stopper {
    fn new(cancel: &Cancel, outputs: &Outputs) -> Stopper {
        let ((ask, asked), (tell, done)) = (mpsc::channel(), mpsc::channel());
        let (cancel, outputs) = (cancel.clone(), outputs.clone());
        std::thread::spawn(move || {
            asked.recv().unwrap();
            cancel.cancel();
            assert!(outputs.abandon().is_empty());
            tell.send(()).unwrap();
        });
        Stopper { ask, done }
    }

    fn stop(&self) {
        self.ask.send(()).unwrap();
        self.done.recv().unwrap();
    }
}

#[test]
fn a_run_ends_at_its_next_batch_and_leaves_no_file() {
    for threads in [1, 3] {
        let (folder, outputs, workers) = (Folder::new(), Outputs::default(), Workers::new(threads));
        let made = outputs.folder(&folder.path("new/plots")).unwrap();
        let file = outputs.file(&folder.path("s.json"), false).unwrap();
        let stopper = Stopper::new(&workers.cancel, &outputs);
        let (scene, rays) = scene("room", 1, 200);
        let workload = workload(&scene.mesh, &program("pipeline", 1), &rays);
        let mut batches = 0;
        let result = run::run(&workload, &machine().spec, &rays, &workers, |_| {
            batches += 1;
            stopper.stop();
            Ok::<_, Infallible>(())
        });
        assert!(matches!(result, Err(RunError::Cancelled(_))), "{result:?}");
        assert_eq!(batches, 1);
        assert_eq!(folder.names(), [""; 0]);
        assert!(file.finish().is_err());
        assert!(outputs.file(&folder.path("t.json"), false).is_err());
        assert!(outputs.folder(&folder.path("more")).is_err());
        drop(made);
        assert_eq!(folder.names(), [""; 0]);
    }
}

#[test]
fn an_image_ends_at_its_next_ray() {
    let workers = Workers::new(2);
    let stopper = Stopper::new(&workers.cancel, &Outputs::default());
    let (scene, rays) = scene("room", 1, 100);
    let workload = &workload(&scene.mesh, &program("pipeline", 1), &rays);
    let (size, sampling) = (ImageSize { width: 100, height: 100 }, Sampling { side: 1, adaptive: None });
    let picture = Picture {
        scene: &scene,
        workload,
        size,
        sampling,
        limits: Limits::default(),
        screen: None,
        rules: Default::default(),
    };
    let spec = &machine().spec;
    let timed = Timed { spec, rules: HostRules::default(), watching: Watching::default() };
    let mut sent = 0;
    let result = run::render(&picture, Some(timed), &workers, |seen| {
        if let Seen::Sent(..) = seen {
            sent += 1;
            stopper.stop();
        }
        Ok::<_, Infallible>(())
    });
    assert!(matches!(result, Err(RunError::Cancelled(_))));
    assert_eq!(sent, 1);
}

/// Ops without an end.
#[test]
fn a_replay_ends_at_its_next_batch() {
    let cancel = Cancel::default();
    let stopper = Stopper::new(&cancel, &Outputs::default());
    let (scene, rays) = scene("room", 1, 8);
    let workload = workload(&scene.mesh, &program("pipeline", 1), &rays);
    let batches = ops(&workload, &rays);
    let result = run::replay::<Infallible>(&machine().spec, workload.costs(), workload.cells(), &cancel, |take| {
        for batch in batches.iter().cycle() {
            take(batch.clone().into())?;
            stopper.ask.send(()).ok();
        }
        Ok(())
    });
    assert!(matches!(result, Err(RunError::Cancelled(_))), "{result:?}");
}

#[test]
fn a_sweep_ends_with_the_points_under_way() {
    let folder = Folder::new();
    folder.file("sweep.ron", r#"(scene: "room", size: 8, grid_coefficient: (from: 1, to: 200, step: 1))"#);
    let sweep = Sweep::read(&folder.path("sweep.ron")).unwrap();
    let workers = Workers::new(2);
    let done = AtomicUsize::new(0);
    let points: Vec<usize> = (0..sweep.points()).collect();
    let result = sweep.run(&points, &workers, RecordingMemory::UNBOUNDED, |_, row| {
        assert_eq!(row.last().unwrap(), "", "a point that was stopped has not failed");
        done.fetch_add(1, Ordering::Relaxed);
        workers.cancel.cancel();
    });
    assert_eq!(result, Err(Cancelled));
    assert_eq!(done.load(Ordering::Relaxed), 1, "of {}", sweep.points());
}
