% Reads what `stribeck identify log.csv --json x.json` wrote, and the log beside it. For Octave 7 and later and MATLAB; CI does not run it.
%
%   stribeck identify log.csv --axis x --json x.json
%   octave read_identification.m        (in the folder of both files)

found = jsondecode(fileread('x.json'));
fprintf('mass %.0f kg, 95 %%: %.0f to %.0f kg\n', found.mass_kg, found.mass_ci95_kg(1), found.mass_ci95_kg(2));
for i = 1:numel(found.warnings)
  fprintf('warning: %s\n', found.warnings{i});
end

% The curve: a point has velocity_mm_per_s, friction_N and ci95_N = [low, high].
velocity = [found.curve.velocity_mm_per_s];
friction = [found.curve.friction_N];
interval = [found.curve.ci95_N];  % two rows
figure;
plot(velocity, friction, velocity, interval, '--');
xlabel('velocity in mm/s');
ylabel('friction in N');

% The log: lines with # before the header, then `name [unit]` and numbers.
file = fopen('log.csv');
lines = 0;
header = '#';
while header(1) == '#'
  header = fgetl(file);
  lines = lines + 1;
end
fclose(file);
names = strsplit(header, ',');
values = dlmread('log.csv', ',', lines, 0);
figure;
plot(values(:, 1), values(:, 2));
xlabel(names{1});
ylabel(names{2});
