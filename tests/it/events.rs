//! The engine of events by itself: its order, its rendezvous, its standstill.

use pcs_sim::machine::Cycles;
use pcs_sim::machine::events::{Act, Buses, Delivery, Events, Message, Sender, Standstill, Turn, Waits};
use pcs_sim::measure::{Measured, Shape, State, StateId, StateKind, States, Topology};

const BUSY: StateId = StateId(0);
const SENDS: StateId = StateId(1);
const WAITS: StateId = StateId(2);
const HELD: StateId = StateId(3);
const IDLE: StateId = StateId(4);

fn topology(stations: usize) -> Topology {
    let kinds = [StateKind::Works, StateKind::Moves, StateKind::Waits, StateKind::Blocked, StateKind::Idle];
    let state = |(id, kind): (u8, StateKind)| State {
        id: StateId(id),
        name: format!("{kind:?}"),
        letter: 'x',
        kind,
        stands_at: None,
        used: true,
    };
    let states = States::new((0..).zip(kinds).map(state));
    Topology { shape: Shape::Farm, stations, states, ..Topology::default() }
}

/// Tasks that each do a list of things, on a bus that takes a cycle a byte. Returns also what each took, in the order of time.
fn run(lists: &[Vec<Act<u32>>]) -> (Result<Measured, Standstill>, Vec<(usize, u32)>) {
    let mut events = Events::new(topology(lists.len()), Buses::new(1, 1000), (SENDS, IDLE));
    let mut places = vec![0; lists.len()];
    let mut took = Vec::new();
    while events.step(&mut |task, _, turn| {
        took.extend(turn.taken().map(|content: u32| (task, content)));
        places[task] += 1;
        turn.act(lists[task].get(places[task] - 1).copied().unwrap_or(Act::End));
    }) {}
    (events.finish().map(|(measured, _)| measured), took)
}

fn message(delivery: Delivery, time: u64, bytes: u64, content: u32) -> Act<u32> {
    Act::Send(Message { delivery, time: Cycles(time), bytes, content })
}

const TAKE: Act<u32> = Act::Receive(Sender::Anyone, WAITS);

#[test]
fn the_first_to_arrive_is_taken_first_and_then_the_lowest_sender() {
    let post =
        |time, bytes, content| vec![Act::Spend(BUSY, Cycles(time)), message(Delivery::Post(0), 0, bytes, content)];
    // Task 3 is first; those of 1 and 2 arrive together, as no bytes take no time.
    let (measured, took) =
        run(&[vec![Act::Spend(BUSY, Cycles(20)), TAKE, TAKE, TAKE], post(9, 0, 1), post(9, 0, 2), post(5, 2, 3)]);
    assert_eq!(took, [(0, 3), (0, 1), (0, 2)]);
    assert_eq!(measured.unwrap().cycles, Cycles(20));
    let (_, took) =
        run(&[vec![Act::Receive(Sender::Task(2), WAITS), TAKE, TAKE], post(9, 0, 1), post(9, 0, 2), post(5, 2, 3)]);
    assert_eq!(took, [(0, 2), (0, 3), (0, 1)]);
}

/// However far apart two times are, the earlier comes first, and of tasks that wake up together the one with the lowest number.
#[test]
fn times_far_apart_keep_their_order() {
    const FAR: u64 = 3 << 61;
    let spend = |cycles| Act::Spend(BUSY, Cycles(cycles));
    let post = |content| message(Delivery::Post(0), 0, 0, content);
    let lists = [
        vec![TAKE; 6],
        vec![spend(FAR), post(1), spend(2), post(4)],
        vec![spend(FAR + 5), post(2)],
        vec![spend(7), post(3), spend(FAR - 7), post(5), spend(5), post(6)],
    ];
    let (measured, took) = run(&lists);
    assert_eq!(took.into_iter().map(|(_, content)| content).collect::<Vec<_>>(), [3, 1, 5, 4, 2, 6]);
    assert_eq!(measured.unwrap().cycles, Cycles(FAR + 5));
}

/// By hand: 3 cycles of work on the message, 4 on the bus, then held until the receiver is done with something else.
#[test]
fn a_rendezvous_holds_its_sender() {
    let sender = vec![message(Delivery::Hold(1, HELD), 3, 4, 7), Act::Spend(BUSY, Cycles(1))];
    let (measured, took) = run(&[sender, vec![Act::Spend(BUSY, Cycles(10)), TAKE]]);
    let measured = measured.unwrap();
    let times = |task: usize| [BUSY, SENDS, WAITS, HELD, IDLE].map(|state| measured.stations[task].of(state).0);
    assert_eq!((measured.cycles, took), (Cycles(11), vec![(1, 7)]));
    assert_eq!((times(0), times(1)), ([1, 7, 0, 3, 0], [10, 0, 0, 0, 1]));
    assert_eq!(measured.links[0].busy, Cycles(4));
    // A receiver that waits already has it in the cycle after the last byte, not earlier.
    let sender = vec![message(Delivery::Hold(1, HELD), 3, 4, 7)];
    let measured = run(&[sender, vec![TAKE]]).0.unwrap();
    assert_eq!((measured.cycles, measured.stations[1].of(WAITS)), (Cycles(7), Cycles(7)));
}

#[test]
fn messages_share_the_bus_and_a_broadcast_takes_it_once() {
    let sender = |content| vec![message(Delivery::Post(0), 0, 5, content)];
    let measured = run(&[vec![TAKE, TAKE], sender(1), sender(2)]).0.unwrap();
    assert_eq!((measured.cycles, measured.links[0].busy), (Cycles(10), Cycles(10)));
    let (measured, took) = run(&[vec![message(Delivery::Broadcast, 0, 5, 9)], vec![TAKE], vec![TAKE]]);
    assert_eq!((measured.unwrap().cycles, took), (Cycles(5), vec![(1, 9), (2, 9)]));
}

#[test]
fn a_standstill_says_who_waits_for_whom() {
    let lists = [
        vec![Act::Receive(Sender::Task(1), WAITS)],
        vec![message(Delivery::Hold(2, HELD), 0, 1, 0)],
        vec![Act::Receive(Sender::Task(0), WAITS)],
        vec![TAKE],
    ];
    let standstill = run(&lists).0.unwrap_err();
    let expected = [
        (0, Waits::For(Sender::Task(1))),
        (1, Waits::On(2)),
        (2, Waits::For(Sender::Task(0))),
        (3, Waits::For(Sender::Anyone)),
    ];
    assert_eq!(standstill.0, expected);
    assert_eq!(
        standstill.to_string(),
        "no task can go on; task 0 waits for a message of task 1; task 1 waits until task 2 takes its message; \
         task 2 waits for a message of task 0; task 3 waits for a message"
    );
}
