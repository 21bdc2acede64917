//! Running ahead: instructions between registers and memory, chain by chain.
//!
//! Nothing is counted from instruction to instruction. What a way through a program comes to is told by where it leaves the straight
//! line: all that stands [before](Executable::before) the place that it leaves, without what stands before that which it comes to.

use super::executable::Executable;
use super::processor::{Flow, Processor};
use super::tally::Tally;
use crate::seam::{Activity, OpStream};

/// Where a cell is. Its counts are less what stands before its address, so that they stay as they are along a straight line.
struct Way {
    address: u32,
    tally: Tally,
    executed: u64,
    /// At more executed instructions than these, there is something else to do.
    horizon: u64,
}

impl Way {
    fn of(cell: &Processor<'_>) -> Way {
        Way {
            address: cell.address,
            tally: cell.tally.without(cell.executable.before(cell.address)),
            executed: cell.executed.wrapping_sub(cell.address.into()),
            horizon: cell.horizon(),
        }
    }

    /// Leaves it at its address, with all that is before an address charged.
    fn leave(&self, cell: &mut Processor<'_>, charged: u32) {
        cell.address = self.address;
        cell.tally = self.tally.with(cell.executable.before(charged));
        cell.executed = self.executed.wrapping_add(charged.into());
    }

    /// Goes on elsewhere.
    #[inline(always)]
    fn turn(&mut self, to: u32, executable: &Executable) {
        let behind = self.address + 1;
        self.tally = self.tally.with(match executable.turns.get(self.address as usize) {
            Some(turn) if turn.to == to => turn.tally,
            _ => executable.before(behind).without(executable.before(to)),
        });
        self.executed = self.executed.wrapping_add(behind.into()).wrapping_sub(to.into());
        self.address = to;
    }
}

impl Processor<'_> {
    /// Executes instructions that work between registers and memory, as far as the next one is such and none fails.
    pub(super) fn run_ahead(&mut self, ops: &mut OpStream) {
        let executable = self.executable;
        let mut way = Way::of(self);
        while let Some(step) = executable.steps.get(way.address as usize) {
            if step.is_edge || step.work != self.work {
                if step.special {
                    break;
                }
                way.leave(self, way.address);
                self.cross_edge(step.work, ops);
                way = Way::of(self);
            }
            let (done, flow) = self.execute_chain(&executable.steps[way.address as usize..], way.address);
            way.address += done as u32;
            match flow {
                Flow::Next => {}
                Flow::To(to) if way.executed.wrapping_add(u64::from(way.address) + 1) <= way.horizon => {
                    way.turn(to, executable);
                }
                Flow::To(to) => {
                    way.leave(self, way.address + 1);
                    if self.is_beyond_limit() {
                        return;
                    }
                    self.count_up_in_time();
                    self.address = to;
                    way = Way::of(self);
                }
                Flow::Failed => return way.leave(self, way.address + 1),
            }
        }
        way.leave(self, way.address);
    }

    /// What is to be done before an instruction that is an edge, or works for another kernel than the one before it.
    fn cross_edge(&mut self, work: Activity, ops: &mut OpStream) {
        self.turn_to(work, ops);
        self.count_events();
        self.count_up_in_time();
    }
}
