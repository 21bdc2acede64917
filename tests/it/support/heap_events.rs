//! A second scheduler, for comparison: all that is to happen lies in one heap, by time, then by task. It knows acts as the engine does and shares
//! nothing else with it.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use pcs_sim::machine::events::{Act, Delivery, Message, Sender};
use pcs_sim::machine::{Cycles, Ipsc2};
use pcs_sim::measure::StateId;

use super::cube_wires::Wires;

#[derive(Clone, Copy)]
enum Doing<M> {
    Something,
    Sending(Message<M>),
    Waiting(StateId),
    Sleeping(StateId),
    Nothing,
}

struct Task<M> {
    doing: Doing<M>,
    /// Since when; and which of its entries in the heap counts.
    since: u64,
    entry: u64,
    /// By arrival, sender, and number.
    mail: BTreeMap<(u64, usize, u64), M>,
    spent: BTreeMap<u8, u64>,
}

/// What came out: the end, and for each task the cycles in each state in which it was.
pub struct Ended {
    pub cycles: u64,
    pub spent: Vec<BTreeMap<u8, u64>>,
    pub links: Vec<[u64; 4]>,
}

/// Lets tasks act until `is_over`, or nothing is left to happen. `tasks` are the nodes, the host, and helpers; `rests` tells since when one has
/// nothing left to do.
pub fn run<P, M: Copy>(
    (machine, tasks): (&Ipsc2, usize),
    program: &mut P,
    next: impl Fn(&mut P, usize, Cycles, Option<&M>) -> Act<M>,
    is_over: impl Fn(&P) -> bool,
    rests: impl Fn(&P, usize) -> Option<Cycles>,
    (sending, idle): (StateId, StateId),
) -> Ended {
    let new = || Task { doing: Doing::Something, since: 0, entry: 0, mail: BTreeMap::new(), spent: BTreeMap::new() };
    let mut all: Vec<Task<M>> = (0..tasks).map(|_| new()).collect();
    let mut heap: BinaryHeap<Reverse<(u64, usize, u64)>> = (0..tasks).map(|task| Reverse((0, task, 0))).collect();
    let (mut wires, mut number, mut now) = (Wires::new(machine), 0, 0);
    let on = |task: usize| if task > machine.nodes { task - machine.nodes - 1 } else { task };
    while !is_over(program) {
        let Some(Reverse((time, task, entry))) = heap.pop() else { break };
        if all[task].entry != entry {
            continue;
        }
        now = time;
        all[task].entry += 1;
        let mut act = match all[task].doing {
            Doing::Sending(message) => Act::Send(Message { time: Cycles(0), ..message }),
            Doing::Waiting(state) => Act::Receive(Sender::Anyone, state),
            _ => next(program, task, Cycles(now), None),
        };
        loop {
            let mut taken = None;
            let mut later = None;
            match act {
                Act::Spend(state, cycles) | Act::Work(state, cycles, _) => {
                    *all[task].spent.entry(state.0).or_default() += cycles.0;
                    later = (cycles.0 > 0).then_some((now + cycles.0, Doing::Something));
                }
                Act::SpendEach(spells) | Act::Job(_, spells) => {
                    for (state, cycles) in spells {
                        *all[task].spent.entry(state.0).or_default() += cycles.0;
                    }
                    let sum: u64 = spells.iter().map(|spell| spell.1.0).sum();
                    later = (sum > 0).then_some((now + sum, Doing::Something));
                }
                Act::Send(message) if message.time.0 > 0 => {
                    *all[task].spent.entry(sending.0).or_default() += message.time.0;
                    later = Some((now + message.time.0, Doing::Sending(message)));
                }
                Act::Send(message) => {
                    let Delivery::Post(to) = message.delivery else { panic!("nodes post") };
                    let at = wires.carry(on(task), on(to), message.bytes, now);
                    number += 1;
                    all[to].mail.insert((at, task, number), message.content);
                    if let Doing::Waiting(_) = all[to].doing {
                        all[to].entry += 1;
                        let first = *all[to].mail.first_key_value().unwrap().0;
                        heap.push(Reverse((first.0.max(now), to, all[to].entry)));
                    }
                }
                Act::Receive(_, state) => {
                    let waited = if let Doing::Waiting(_) = all[task].doing { now - all[task].since } else { 0 };
                    *all[task].spent.entry(state.0).or_default() += waited;
                    all[task].since = now;
                    match all[task].mail.first_key_value().map(|(key, _)| *key) {
                        Some(key) if key.0 <= now => {
                            taken = all[task].mail.remove(&key);
                            all[task].doing = Doing::Something;
                        }
                        first => {
                            all[task].doing = Doing::Waiting(state);
                            first.into_iter().for_each(|key| heap.push(Reverse((key.0, task, all[task].entry))));
                            break;
                        }
                    }
                }
                Act::Poll => {
                    let first = all[task].mail.first_key_value().map(|(key, _)| *key).filter(|key| key.0 <= now);
                    taken = first.and_then(|key| all[task].mail.remove(&key));
                }
                Act::Sleep(state) => {
                    (all[task].doing, all[task].since) = (Doing::Sleeping(state), now);
                    break;
                }
                Act::Wake(other) => {
                    if let Doing::Sleeping(state) | Doing::Waiting(state) = all[other].doing {
                        *all[other].spent.entry(state.0).or_default() += now - all[other].since;
                        all[other].doing = Doing::Something;
                        all[other].entry += 1;
                        heap.push(Reverse((now, other, all[other].entry)));
                    }
                }
                Act::Begin(_) | Act::Done => {}
                Act::End => {
                    all[task].doing = Doing::Nothing;
                    break;
                }
            }
            if let Some((until, doing)) = later {
                all[task].doing = doing;
                heap.push(Reverse((until, task, all[task].entry)));
                break;
            }
            act = next(program, task, Cycles(now), taken.as_ref());
        }
    }
    for (number, task) in all.iter_mut().enumerate() {
        if let Doing::Waiting(state) | Doing::Sleeping(state) = task.doing {
            let until = rests(program, number).map_or(now, |since| since.0);
            *task.spent.entry(state.0).or_default() += until - task.since.min(until);
        }
        let sum: u64 = task.spent.values().sum();
        *task.spent.entry(idle.0).or_default() += now - sum;
        task.spent.retain(|_, cycles| *cycles > 0);
    }
    Ended { cycles: now, spent: all.into_iter().map(|task| task.spent).collect(), links: wires.taken() }
}
