function [result, info] = robot(what, varargin)
% mbk.robot  The commands 'mbk robot ...': identify, force, check, describe, workspace.
%
%   [RESULT, INFO] = mbk.robot('identify', ..., NAME, VALUE, ...) does what 'mbk robot identify' does. Behind the name of the
%   command stand data (see 'help mbk.measure'), names of files or other words, as a text or a cell of several, and then
%   options with their values. RESULT is the document of --json as a struct, or text where the command has none.
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run(['robot ' char(what)], varargin);
end
