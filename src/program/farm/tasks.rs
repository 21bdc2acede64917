//! What each task of a farm does: the station, the master, and the workers.
//!
//! A worker asks, is told of an item, says that it has understood, and computes; of the three messages the master waits for
//! the last one from just this worker (thesis, chapter 5, section 3.4). Each of the three is a rendezvous. The colour of each pixel
//! goes to the station, and the worker does not wait for it to be taken.

use serde::{Deserialize, Serialize};

use super::items::Items;
use super::pixels::{UNITS, prices};
use crate::machine::events::{Act, Delivery, Explanation, Message, PIECE_UNITS, Sender, Work};
use crate::machine::{Capitan, Cycles};
use crate::measure::{Names, PathUnit, Shape, State, StateId, StateKind, States, Topology};
use crate::program::work;
use crate::seam::Unit;

/// How work items come to the workers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum HandOut {
    /// One by one, to the worker that asks.
    #[default]
    Request,
    /// Dealt beforehand: of n workers the k-th has every n-th item from the k-th on, and asks once.
    Dealt,
}

/// How the scene comes to the master and to the workers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum SceneBy {
    /// A copy for each, one after the other.
    #[default]
    Copies,
    /// One broadcast for all.
    Broadcast,
}

/// What is in a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Letter {
    /// The scene and the view.
    Scene,
    /// `m_ack`: the task with this number is ready.
    Ready(u32),
    /// `m_dial`: an item to begin with.
    Item(u32),
    /// `m_dial`: there are no more.
    End,
    /// `m_coul`: the colour of a pixel.
    Color,
}

/// Bytes of an integer on a 68020.
const INTEGER: u64 = 4;

const STATION: usize = 0;
const MASTER: usize = 1;
const FIRST_WORKER: usize = 2;

const COMPUTING: StateId = StateId(0);
const SENDING: StateId = StateId(1);
const RECEIVING: StateId = StateId(2);
const WAITING_SCENE: StateId = StateId(3);
const WAITING_ITEM: StateId = StateId(4);
const WAITING_MASTER: StateId = StateId(5);
const WAITING_ANSWER: StateId = StateId(6);
const WAITING_MAIL: StateId = StateId(7);
const IDLE: StateId = StateId(8);

/// The units of work of tasks are those of a pixel in a scene of polygons, and then these.
const FIXED: Unit = Unit(UNITS as u8);
const PER_CAP: Unit = Unit(UNITS as u8 + 1);
const MESSAGE: Unit = Unit(UNITS as u8 + 2);
const SEGMENT: Unit = Unit(UNITS as u8 + 3);
const PIXEL: Unit = Unit(UNITS as u8 + 4);
const COLOR: Unit = Unit(UNITS as u8 + 5);
const BUS: Unit = Unit(UNITS as u8 + 6);

/// The states of tasks: the waiting ones are for the scene, for a work item (called `noun`), until the master takes a message,
/// for the answer of one task, and for a message of anyone.
pub fn states(noun: &str) -> States {
    let state = |(id, name, letter, kind): (StateId, String, char, StateKind)| State {
        id,
        name,
        letter,
        kind,
        stands_at: None,
        used: true,
    };
    let waiting = |what: &str| format!("waiting {what}");
    let all = [
        (COMPUTING, "computing".to_owned(), 'c', StateKind::Works),
        (SENDING, "sending".to_owned(), 's', StateKind::Moves),
        (RECEIVING, "receiving".to_owned(), 'r', StateKind::Moves),
        (WAITING_SCENE, waiting("scene"), '_', StateKind::Waits),
        (WAITING_ITEM, waiting(noun), '.', StateKind::Waits),
        (WAITING_MASTER, waiting("master"), '!', StateKind::Blocked),
        (WAITING_ANSWER, waiting("answer"), ':', StateKind::Waits),
        (WAITING_MAIL, waiting("mail"), ',', StateKind::Waits),
        (IDLE, "idle".to_owned(), ' ', StateKind::Idle),
    ];
    States::new(all.into_iter().map(state))
}

/// A farm at work: what each of its tasks has come to.
#[derive(Clone, Debug)]
pub struct Farm<'a> {
    machine: &'a Capitan,
    items: &'a Items,
    scene_bytes: u64,
    scene_by: SceneBy,
    hand_out: HandOut,
    station: Station,
    master: Master,
    workers: Vec<Worker>,
    /// The next item that is handed out on request.
    next_item: usize,
    /// Which workers have asked, of those that ask once.
    has_asked: Vec<bool>,
    /// How many workers have not been told that there are no more.
    at_work: usize,
}

#[derive(Clone, Copy, Debug)]
enum Station {
    Reads,
    /// Sends the scene to that task.
    GivesOut(usize),
    /// Takes colours, so many more.
    Files(usize),
}

#[derive(Clone, Copy, Debug)]
enum Master {
    Begins,
    /// Takes the request of any worker.
    Listens,
    /// Has answered that worker, and waits for it.
    Answered(usize),
}

#[derive(Clone, Copy, Debug)]
enum Worker {
    Begins,
    Asks,
    Listens,
    IsTold,
    /// Has been told of an item.
    Has(usize),
    /// Sets that item up.
    SetsUp(usize),
    /// Computes the pixel at that place of the item.
    Computes(usize, usize),
    /// Sends its colour.
    Shows(usize, usize),
    Ends,
}

impl<'a> Farm<'a> {
    /// A farm of so many workers at the start. The scene has so many bytes.
    pub fn new(
        machine: &'a Capitan,
        items: &'a Items,
        (scene_bytes, scene_by): (u64, SceneBy),
        (workers, hand_out): (usize, HandOut),
    ) -> Farm<'a> {
        Farm {
            machine,
            items,
            scene_bytes,
            scene_by,
            hand_out,
            station: Station::Reads,
            master: Master::Begins,
            workers: vec![Worker::Begins; workers],
            next_item: 0,
            has_asked: vec![false; workers],
            at_work: workers,
        }
    }

    /// The tasks and their states.
    pub fn topology(&self) -> Topology {
        let workers = (1..=self.workers.len()).map(|number| format!("CAP {number}"));
        let names = Names {
            machine: "farm".to_owned(),
            station: "task".to_owned(),
            stations: ["Station".to_owned(), "Maitre".to_owned()].into_iter().chain(workers).collect(),
            fifo: "queue".to_owned(),
            word: "message".to_owned(),
            job: self.items.noun.to_owned(),
            job_time: "from when a worker begins them until they are done".to_owned(),
        };
        let stations = self.tasks();
        Topology { shape: Shape::Farm, stations, fifos: Vec::new(), states: states(self.items.noun), names }
    }

    /// The states of a task that sends, and of one that has ended.
    pub const SENDING_AND_IDLE: (StateId, StateId) = (SENDING, IDLE);

    /// By what names its causes are told: those of what they take in the machine's file; `bus_message` is a message on a bus. Of a pixel that
    /// is made up, and of a message on a bus, it tells about what they take.
    pub fn explanation(&self) -> Explanation {
        const { assert!(UNITS == PIECE_UNITS) };
        let unit = |name: &str, state, cycles| PathUnit { name: name.to_owned(), state, cycles };
        let vocabulary = work::vocabulary(false);
        let of_pixel = vocabulary.units.iter().zip(prices(self.machine)).map(|(known, price)| {
            let name = if known.name == "host_hit" { "shade_hit" } else { &known.name };
            unit(name, COMPUTING, price)
        });
        let costs = &self.machine.costs;
        let others = [
            unit("fixed_ms", COMPUTING, costs.fixed),
            unit("per_cap_ms", SENDING, costs.per_cap),
            unit("message_ms", SENDING, costs.message),
            unit("segment_ms", COMPUTING, costs.segment),
            unit("pixel_ms", COMPUTING, costs.pixel),
            unit("color_ms", RECEIVING, costs.color),
            unit("bus_message", SENDING, self.machine.buses.time(self.machine.header_bytes)),
        ];
        Explanation {
            units: of_pixel.chain(others).collect(),
            carrying: [BUS, BUS],
            pieces: self.items.counts().to_vec(),
        }
    }

    /// What a task spends on a message, by what is in it: nothing on a colour.
    pub fn sending(letter: &Letter) -> Option<Unit> {
        match letter {
            Letter::Scene => Some(PER_CAP),
            Letter::Ready(_) | Letter::Item(_) | Letter::End => Some(MESSAGE),
            Letter::Color => None,
        }
    }

    /// How many tasks there are.
    fn tasks(&self) -> usize {
        FIRST_WORKER + self.workers.len()
    }

    /// What a task does next, given the message that it has just taken, if it waited for one.
    pub fn next(&mut self, task: usize, taken: Option<&Letter>) -> Act<Letter> {
        match task {
            STATION => self.station(taken),
            MASTER => self.master(taken),
            _ => self.worker(task - FIRST_WORKER, taken),
        }
    }

    /// Reads the scene, gives it out, and files the colours of all pixels.
    fn station(&mut self, taken: Option<&Letter>) -> Act<Letter> {
        let costs = &self.machine.costs;
        match self.station {
            Station::Reads => {
                self.station = Station::GivesOut(MASTER);
                Act::Work(COMPUTING, costs.fixed, Work::Unit(FIXED))
            }
            Station::GivesOut(to) if to < self.tasks() => {
                let (delivery, next) = match self.scene_by {
                    SceneBy::Copies => (Delivery::Hold(to, WAITING_ANSWER), to + 1),
                    SceneBy::Broadcast => (Delivery::Broadcast, self.tasks()),
                };
                self.station = Station::GivesOut(next);
                self.send(delivery, costs.per_cap, Letter::Scene)
            }
            Station::GivesOut(_) => {
                self.station = Station::Files(self.items.pixels().len());
                self.station(None)
            }
            Station::Files(left) if taken.is_some() => {
                self.station = Station::Files(left - 1);
                Act::Work(RECEIVING, costs.color, Work::Unit(COLOR))
            }
            Station::Files(0) => Act::End,
            Station::Files(_) => Act::Receive(Sender::Anyone, WAITING_MAIL),
        }
    }

    /// Answers one worker after the other, and waits for each.
    fn master(&mut self, taken: Option<&Letter>) -> Act<Letter> {
        match (self.master, taken) {
            (Master::Begins, _) => {
                self.master = Master::Listens;
                Act::Receive(Sender::Task(STATION), WAITING_SCENE)
            }
            (Master::Listens, Some(&Letter::Ready(worker))) => {
                self.master = Master::Answered(worker as usize);
                let answer = self.answer(worker as usize);
                self.send(Delivery::Hold(worker as usize, WAITING_ANSWER), self.machine.costs.message, answer)
            }
            (Master::Answered(worker), None) => Act::Receive(Sender::Task(worker), WAITING_ANSWER),
            (Master::Answered(_) | Master::Listens, _) if self.at_work == 0 => Act::End,
            (Master::Answered(_) | Master::Listens, _) => {
                self.master = Master::Listens;
                Act::Receive(Sender::Anyone, WAITING_MAIL)
            }
        }
    }

    /// What a worker that asks is told.
    fn answer(&mut self, task: usize) -> Letter {
        let worker = task - FIRST_WORKER;
        let item = match self.hand_out {
            HandOut::Request => self.next_item,
            HandOut::Dealt if std::mem::replace(&mut self.has_asked[worker], true) => self.items.len(),
            HandOut::Dealt => worker,
        };
        if item < self.items.len() {
            self.next_item += 1;
            return Letter::Item(item as u32);
        }
        self.at_work -= 1;
        Letter::End
    }

    /// Asks, computes, and asks again.
    fn worker(&mut self, worker: usize, taken: Option<&Letter>) -> Act<Letter> {
        let costs = &self.machine.costs;
        let ready = Letter::Ready((FIRST_WORKER + worker) as u32);
        let (next, act) = match self.workers[worker] {
            Worker::Begins => (Worker::Asks, Act::Receive(Sender::Task(STATION), WAITING_SCENE)),
            Worker::Asks => (Worker::Listens, self.to_master(ready)),
            Worker::Listens => (Worker::IsTold, Act::Receive(Sender::Task(MASTER), WAITING_ITEM)),
            Worker::IsTold => match taken {
                Some(&Letter::Item(item)) => (Worker::Has(item as usize), self.to_master(ready)),
                _ => (Worker::Ends, self.to_master(ready)),
            },
            Worker::Has(item) => (Worker::SetsUp(item), Act::Begin(item as u32)),
            Worker::SetsUp(item) => {
                let set_up = Act::Work(COMPUTING, costs.segment, Work::Unit(SEGMENT));
                (Worker::Computes(item, self.items.range(item).start), set_up)
            }
            Worker::Computes(item, pixel) if pixel < self.items.range(item).end => {
                (Worker::Shows(item, pixel), self.compute(pixel))
            }
            Worker::Computes(item, _) => (self.after(item), Act::Done),
            Worker::Shows(item, pixel) => {
                let color = self.send(Delivery::Post(STATION), Cycles(0), Letter::Color);
                (Worker::Computes(item, pixel + 1), color)
            }
            Worker::Ends => (Worker::Ends, Act::End),
        };
        self.workers[worker] = next;
        act
    }

    /// What a worker does that has done an item.
    fn after(&self, item: usize) -> Worker {
        let next = item + self.workers.len();
        let has_more = self.hand_out == HandOut::Dealt && next < self.items.len();
        if has_more { Worker::Has(next) } else { Worker::Asks }
    }

    fn to_master(&self, letter: Letter) -> Act<Letter> {
        self.send(Delivery::Hold(MASTER, WAITING_MASTER), self.machine.costs.message, letter)
    }

    /// What it takes to compute a pixel.
    fn compute(&self, pixel: usize) -> Act<Letter> {
        let work = if self.items.counts().is_empty() { Work::Unit(PIXEL) } else { Work::Piece(pixel as u32) };
        Act::Work(COMPUTING, self.items.pixels()[pixel], work)
    }

    fn send(&self, delivery: Delivery, time: Cycles, letter: Letter) -> Act<Letter> {
        let inside = match letter {
            Letter::Scene => self.scene_bytes,
            Letter::Ready(_) => 0,
            Letter::End => INTEGER,
            Letter::Item(_) => 2 * INTEGER,
            Letter::Color => 5 * INTEGER,
        };
        Act::Send(Message { delivery, time, bytes: self.machine.header_bytes + inside, content: letter })
    }
}
