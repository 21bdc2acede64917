//! A cache that gives up what was read longest ago.

/// The pages in a node's cache.
#[derive(Clone, Debug)]
pub struct Lru {
    /// For each page, the one that was read before it and the one after it, if it is in the cache; the last entry is the list's end.
    links: Vec<(u32, u32)>,
    held: usize,
    most: usize,
}

const ABSENT: u32 = u32::MAX;

impl Lru {
    /// A cache for so many of so many pages, at least one.
    pub fn new(pages: u32, most: usize) -> Lru {
        let mut links = vec![(ABSENT, ABSENT); pages as usize + 1];
        links[pages as usize] = (pages, pages);
        Lru { links, held: 0, most: most.max(1) }
    }

    /// Reads a page. False if it was not there; then it is from now on.
    pub fn read(&mut self, page: u32) -> bool {
        let is_here = self.links[page as usize].0 != ABSENT;
        let end = self.links.len() as u32 - 1;
        if is_here {
            self.unlink(page);
        } else if self.held == self.most {
            let oldest = self.links[end as usize].1;
            self.unlink(oldest);
        } else {
            self.held += 1;
        }
        let newest = self.links[end as usize].0;
        self.links[page as usize] = (newest, end);
        self.links[newest as usize].1 = page;
        self.links[end as usize].0 = page;
        is_here
    }

    fn unlink(&mut self, page: u32) {
        let (before, after) = self.links[page as usize];
        self.links[before as usize].1 = after;
        self.links[after as usize].0 = before;
        self.links[page as usize] = (ABSENT, ABSENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_holds_what_was_read_last(reads in prop::collection::vec(0u32..8, 0..200), most in 1usize..8) {
            let mut cache = Lru::new(8, most);
            let mut held: Vec<u32> = Vec::new();
            for page in reads {
                let here = held.iter().position(|&known| known == page);
                prop_assert_eq!(cache.read(page), here.is_some());
                here.into_iter().for_each(|place| { held.remove(place); });
                held.push(page);
                if held.len() > most {
                    held.remove(0);
                }
            }
        }
    }
}
