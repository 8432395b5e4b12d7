//! What fuzz targets share: a clock, random numbers that can be had again, a watch over memory and over cases that do not end.

use std::alloc::{GlobalAlloc, Layout, System};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use std::{env, process, thread};

/// Keeps account of the memory that is in use and of the most that was.
struct Watched;

static IN_USE: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed on unchanged to the system's allocator.
#[expect(unsafe_code, reason = "a global allocator cannot be written without it")]
unsafe impl GlobalAlloc for Watched {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let in_use = IN_USE.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(in_use, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Watched = Watched;

/// Duration after which a case counts as one that does not end.
const LONGEST: Duration = Duration::from_secs(20);

/// Random numbers: SplitMix64 (Steele, Lea and Flood 2014).
pub struct Random(u64);

impl Random {
    /// The next number.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `end`; 0 if that is 0.
    pub fn below(&mut self, end: usize) -> usize {
        if end == 0 { 0 } else { (self.next() % end as u64) as usize }
    }
}

/// Runs `case` with other random numbers again and again: for `--seconds` (60 by default), or once with those of `--case`. Which
/// ones follows from `--seed`, by default from the time; it is printed.
/// A case that panics, asks for more than `most_memory` bytes or does not end is told with its number, and ends the program with 1.
pub fn fuzz(name: &str, most_memory: usize, mut case: impl FnMut(&mut Random)) -> ExitCode {
    let options: Vec<String> = env::args().collect();
    let option = |name: &str| {
        let at = options.iter().position(|option| option == name)?;
        options.get(at + 1)?.parse::<u64>().ok()
    };
    let (only, seconds) = (option("--case"), option("--seconds").unwrap_or(60));
    let first = only.or(option("--seed")).unwrap_or_else(seed_of_the_time);
    println!("{name}: `--seed {first}` does these cases again");
    let (start, mut number) = (Instant::now(), first);
    watch(name);
    loop {
        CASE.store(number, Ordering::Relaxed);
        let before = IN_USE.load(Ordering::Relaxed);
        MOST.store(before, Ordering::Relaxed);
        let done = catch_unwind(AssertUnwindSafe(|| case(&mut Random(number << 16))));
        let most = MOST.load(Ordering::Relaxed) - before;
        if done.is_err() || most > most_memory {
            let what = if done.is_err() { "panicked".to_owned() } else { format!("took {most} bytes of memory") };
            eprintln!("{name}: case {number} {what}; `--case {number}` runs it again");
            return ExitCode::FAILURE;
        }
        number = number.wrapping_add(1);
        if only.is_some() || start.elapsed() >= Duration::from_secs(seconds) {
            println!("{name}: {} cases in {:.0} s", number.wrapping_sub(first), start.elapsed().as_secs_f64());
            return ExitCode::SUCCESS;
        }
    }
}

/// A seed that was not there before: microseconds.
fn seed_of_the_time() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // Cases are told apart by 48 bits.
    since.as_micros() as u64 & ((1 << 48) - 1)
}

/// The case that runs now.
static CASE: AtomicU64 = AtomicU64::new(0);

/// Ends the program if a case does not end.
fn watch(name: &str) {
    let name = name.to_owned();
    thread::spawn(move || {
        let mut last = u64::MAX;
        loop {
            thread::sleep(LONGEST);
            let now = CASE.load(Ordering::Relaxed);
            if now == last {
                eprintln!("{name}: case {now} does not end; `--case {now}` runs it again");
                process::exit(1);
            }
            last = now;
        }
    });
}
